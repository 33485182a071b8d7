//! How exact the bearings of a detector are, from the detections alone.
//!
//! # Reference
//! P. J. Rousseeuw, C. Croux, Alternatives to the median absolute deviation, JASA 88 (1993), for the factor of the median.
//!
//! # Symbols
//! β₋, β, β₊ bearings of one target at three scans in a row; d = β₋ − 2β + β₊; σ the standard deviation of each.
//!
//! # Method
//! The bearing of a target is nearly a line over three scans, so var d = 6σ². For each detection the nearest ones of the scans
//! before and behind are taken, if they are within a few cells; σ = 1.4826 median |d| / √6.

use crate::model::angle::wrap;
use crate::model::scan::{Detection, Measurement, Recording, Scan};

/// Neighbours in time are looked for within this many cells.
const REACH_CELLS: f64 = 3.0;
/// Fewer triples say nothing.
const LEAST_TRIPLES: usize = 20;
/// No estimate is below this share of a cell: levels are rounded, beams are no perfect curves.
const LEAST_SHARE: f64 = 0.05;
const OF_MEDIAN: f64 = 1.4826;

/// σ; `None` where too few detections follow each other.
pub fn estimated_sigma_rad(recording: &Recording, cell_rad: f64) -> Option<f64> {
    let mut sizes = Vec::new();
    for scans in recording.scans.windows(3) {
        for middle in &scans[1].detections {
            let Some(middle_rad) = bearing(middle) else {
                continue;
            };
            let off =
                |scan: &Scan| nearest_offset(&scan.detections, middle_rad, REACH_CELLS * cell_rad);
            if let (Some(before), Some(behind)) = (off(&scans[0]), off(&scans[2])) {
                sizes.push((before + behind).abs());
            }
        }
    }
    if sizes.len() < LEAST_TRIPLES {
        return None;
    }
    let middle = sizes.len() / 2;
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    Some((OF_MEDIAN * median / 6f64.sqrt()).max(LEAST_SHARE * cell_rad))
}

fn bearing(detection: &Detection) -> Option<f64> {
    match detection.measurement {
        Measurement::Bearing { bearing_rad } => Some(bearing_rad),
        _ => None,
    }
}

fn nearest_offset(detections: &[Detection], bearing_rad: f64, reach_rad: f64) -> Option<f64> {
    let offsets = detections
        .iter()
        .filter_map(|other| Some(wrap(bearing(other)? - bearing_rad)));
    offsets
        .filter(|offset| offset.abs() <= reach_rad)
        .min_by(|left, right| left.abs().total_cmp(&right.abs()))
}
