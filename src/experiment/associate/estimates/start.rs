//! A first guess of a sensor's noise, before anything is tracked: each detection with its nearest ones in the scans before and
//! after. Most of such triples may be of clutter; those of targets are the ones that lie straightest.

use super::differences::{MOST_VALUES, Residuals, Seen};
use crate::model::angle::wrap;
use crate::model::scan::{Measurement, Recording, Scan};
use crate::model::state::Position;

const MOST_TRIPLES: usize = 200;
/// Detections of a scan that are looked at.
const MOST_OF_A_SCAN: usize = 200;
/// The guess is this much larger than what is found: a gate that is too wide finds targets, one that is too narrow none.
const MARGIN: f64 = 2.0;

/// σ of each value of a sensor's reports: `None` where no three scans in a row tell it.
pub fn guess(recording: &Recording, sensor: usize) -> [Option<f64>; MOST_VALUES] {
    let scans: Vec<&Scan> = recording
        .scans
        .iter()
        .filter(|scan| scan.sensor == sensor)
        .collect();
    let triples: Vec<&[&Scan]> = scans
        .windows(3)
        .filter(|triple| triple.iter().all(|scan| !scan.detections.is_empty()))
        .collect();
    let every = triples.len().div_ceil(MOST_TRIPLES).max(1);
    let mut residuals = Residuals::default();
    for triple in triples.into_iter().step_by(every) {
        let [before, now, after] = triple else {
            continue;
        };
        for detection in now.detections.iter().take(MOST_OF_A_SCAN) {
            let seen = |scan: &Scan, report| Seen {
                time_s: scan.time_s,
                report,
            };
            let report = detection.measurement;
            let first = seen(before, nearest(before, &report));
            let third = seen(after, nearest(after, &report));
            residuals.add([&first, &seen(now, report), &third]);
        }
    }
    std::array::from_fn(|axis| residuals.least_sigma(axis).map(|sigma| MARGIN * sigma))
}

/// The report of a scan that lies nearest; the scan has one.
fn nearest(scan: &Scan, report: &Measurement) -> Measurement {
    let reports = scan.detections.iter().take(10 * MOST_OF_A_SCAN);
    let mut best = (f64::INFINITY, *report);
    for detection in reports {
        let squared = squared_distance(&detection.measurement, report);
        if squared < best.0 {
            best = (squared, detection.measurement);
        }
    }
    best.1
}

fn squared_distance(one: &Measurement, other: &Measurement) -> f64 {
    if let (
        Measurement::Bearing { bearing_rad: one },
        Measurement::Bearing { bearing_rad: other },
    ) = (one, other)
    {
        return wrap(one - other).powi(2);
    }
    let place = |report: &Measurement| report.position_seen_from(&Position::zeros());
    match (place(one), place(other)) {
        (Some(one_m), Some(other_m)) => (one_m - other_m).norm_squared(),
        _ => f64::INFINITY,
    }
}
