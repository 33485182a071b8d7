//! Mode S as it comes, where it is a text: BaseStation, rs1090, AVR. Frames of AVR are of the time of their arrival, unless a start
//! is given.

use super::{Arrivals, Listener, Piece, Reports};
use crate::formats::mode_s::{Decoder, LineReader, Receiver, Told};
use crate::formats::{Reading, Units};
use crate::model::fault::Fault;

/// Aircraft that are known at most; beyond it they are made known anew.
const MOST_AIRCRAFT: usize = 100_000;

pub(super) fn follow(
    arrivals: &mut dyn Arrivals,
    reading: &Reading,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let told = Told {
        start_s: reading.start_s().ok().flatten(),
        receiver: reading.receiver.map(|frame| Receiver {
            lat_deg: frame.latitude_deg(),
            lon_deg: frame.longitude_deg(),
        }),
        utc_offset_s: reading.utc_offset_s,
        ..Told::default()
    };
    let mut decoder = Decoder::new("line", &told);
    let mut reports = Reports::of(&mut decoder.feed, reading)?;
    let (mut reader, mut number) = (None, 0);
    while let Some(piece) = arrivals.next() {
        match piece {
            Piece::Whole(lines) => {
                let known = match reader.take() {
                    Some(known) => known,
                    None => LineReader::live(&lines, &told)?,
                };
                let reader = reader.insert(known);
                reader.arrived_s = Some(arrivals.arrived_s());
                for line in lines.split_inclusive(|byte| *byte == b'\n') {
                    number += 1;
                    reader.take(&mut decoder, line, number);
                }
            }
            Piece::Broken(reason) => {
                number += 1;
                decoder.feed.reject(reason, number, 1);
            }
        }
        decoder.forget_beyond(MOST_AIRCRAFT);
        reports.hand_on(&mut decoder.feed, listener)?;
    }
    let mut feed = decoder.finish();
    reports.hand_on(&mut feed, listener)?;
    Ok(feed.units)
}
