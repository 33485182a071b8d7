//! Which target each detection came from, where truth is known, and what that says of the detector.
//!
//! # Method
//! In each scan pairs of a detection and a true bearing, at the time of the scan and not more than the gate apart, are taken from the
//! nearest on: a detection has one origin, a target one detection. Two targets in one beam are one detection, that of the nearer.

use crate::model::angle::wrap;
use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording, Scan};
use crate::model::space::Space;
use crate::model::truth::TruthSet;
use serde::Serialize;

/// How well a detector works where truth is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quality {
    /// Share of the true bearings at the scans that have a detection; `None` where there are none.
    pub p_d: Option<f64>,
    /// Detections without a target, on average.
    pub false_alarms_per_scan: Option<f64>,
    /// Of detections with a target.
    pub bearing_rmse_deg: Option<f64>,
    pub gate_deg: f64,
}

#[derive(Default)]
struct Counts {
    true_bearings: u64,
    found: u64,
    square_errors: f64,
}

/// The recording with the origin of each detection, and the quality that follows.
///
/// # Errors
/// None for a recording that was sound before.
pub fn assign_origins(
    recording: Recording,
    truth: &TruthSet,
    gate_deg: f64,
) -> Result<(Recording, Quality), Vec<Fault>> {
    let mut parts = recording.into_parts();
    let mut counts = Counts::default();
    for scan in &mut parts.scans {
        for (error_rad, detection, target) in
            matches(scan, truth, gate_deg.to_radians(), &mut counts)
        {
            scan.detections[detection].origin = Some(target as u32);
            counts.found += 1;
            counts.square_errors += error_rad * error_rad;
        }
    }
    let false_alarms = parts
        .detections()
        .filter(|detection| detection.origin.is_none())
        .count() as f64;
    let share = |sum: f64, count: f64| (count > 0.0).then(|| sum / count);
    let quality = Quality {
        p_d: share(counts.found as f64, counts.true_bearings as f64),
        false_alarms_per_scan: share(false_alarms, parts.scans.len() as f64),
        bearing_rmse_deg: share(counts.square_errors, counts.found as f64)
            .map(|mean| mean.sqrt().to_degrees()),
        gate_deg,
    };
    parts.targets = truth
        .targets()
        .iter()
        .map(|target| target.truth_id.clone())
        .collect();
    parts.origins_known = true;
    Ok((Recording::new(parts)?, quality))
}

/// Error, detection and target of each pair that is taken.
fn matches(
    scan: &Scan,
    truth: &TruthSet,
    gate_rad: f64,
    counts: &mut Counts,
) -> Vec<(f64, usize, usize)> {
    let mut pairs = Vec::new();
    for (index, target) in truth.targets().iter().enumerate() {
        let Some(place) = target.position_at(Space::Bearing, scan.time_s, f64::INFINITY) else {
            continue;
        };
        counts.true_bearings += 1;
        for (number, detection) in scan.detections.iter().enumerate() {
            if let Measurement::Bearing { bearing_rad } = detection.measurement {
                let error_rad = wrap(bearing_rad - place.x).abs();
                pairs.extend((error_rad <= gate_rad).then_some((error_rad, number, index)));
            }
        }
    }
    pairs.sort_by(|left, right| left.0.total_cmp(&right.0));
    let mut taken: Vec<(f64, usize, usize)> = Vec::new();
    for pair in pairs {
        if !taken
            .iter()
            .any(|other| other.1 == pair.1 || other.2 == pair.2)
        {
            taken.push(pair);
        }
    }
    taken
}
