//! AIS as it comes. Where nothing says the time of a message, and no start is given, it is that of its arrival.

use super::{Arrivals, Listener, Piece, Reports};
use crate::formats::ais::{Decoder, Told};
use crate::formats::{Reading, Units};
use crate::model::fault::Fault;

/// Ships that are known at most; beyond it they are made known anew.
const MOST_SHIPS: usize = 200_000;

pub(super) fn follow(
    arrivals: &mut dyn Arrivals,
    reading: &Reading,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let start_s = reading.start_s().ok().flatten();
    let told = Told {
        start_s,
        utc_offset_s: reading.utc_offset_s,
    };
    let mut decoder = Decoder::new(&told);
    let mut reports = Reports::of(&mut decoder.feed, reading)?;
    let mut number = 0;
    while let Some(piece) = arrivals.next() {
        decoder.arrived_s = start_s.is_none().then(|| arrivals.arrived_s());
        match piece {
            Piece::Whole(lines) => {
                for line in lines.split_inclusive(|byte| *byte == b'\n') {
                    number += 1;
                    decoder.take(line, number);
                }
            }
            Piece::Broken(reason) => {
                number += 1;
                decoder.feed.reject(reason, number, 1);
            }
        }
        decoder.forget_beyond(MOST_SHIPS);
        reports.hand_on(&mut decoder.feed, listener)?;
    }
    let mut feed = decoder.finish();
    reports.hand_on(&mut feed, listener)?;
    Ok(feed.units)
}
