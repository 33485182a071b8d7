//! ASTERIX as it comes: blocks, one after another or in datagrams. The day of the times is that of the arrival, unless it is given.

use super::{Arrivals, Listener, Piece, Reports};
use crate::formats::asterix::{Stream, Told};
use crate::formats::{Reading, Units};
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;

pub(super) fn follow(
    arrivals: &mut dyn Arrivals,
    reading: &Reading,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let told = Told {
        kind: Some(DatasetKind::Detections),
        day_s: reading.day_s().ok().flatten(),
        with_test_targets: reading.test_targets,
        editions: reading.editions.clone(),
    };
    let mut stream = Stream::new(told)?;
    let mut reports = Reports::of(&mut stream.gathering.feed, reading)?;
    while let Some(piece) = arrivals.next() {
        match piece {
            Piece::Whole(blocks) => stream.take(&blocks, arrivals.arrived_s()),
            Piece::Broken(reason) => stream.gathering.reject(reason),
        }
        stream.forget();
        reports.hand_on(&mut stream.gathering.feed, listener)?;
    }
    Ok(stream.gathering.feed.units)
}
