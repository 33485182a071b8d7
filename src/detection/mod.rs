//! Finds detections in a bearing-time record: cells whose power, averaged over an interval, stands out of a threshold, are
//! bearings where they are the highest of their neighbourhood.
//!
//! # Reference
//! H. M. Finn, R. S. Johnson, Adaptive detection mode with threshold control as a function of spatially sampled
//! clutter-level estimates, RCA Review 29 (1968), for the threshold; J. O. Smith, X. Serra, PARSHL, ICMC 1987, section on
//! peak interpolation, for the parabola.
//!
//! # Symbols
//! P_b mean power of cell b over the rows of an interval; L_b = 10 log10 P_b; Δ width of a cell; β̂ the bearing found.
//!
//! # Method
//! 1. Rows are put together in intervals of `every_s`; their powers, not their levels, are averaged. The time of a scan is
//!    the mean of the times of its rows.
//! 2. A cell is a detection if P_b is above its threshold ([`threshold`]) and above both neighbours (of equals the first). Where
//!    the axis does not go round, its two outermost cells have one neighbour and are none.
//! 3. β̂ = β_b + Δ (L₋ − L₊) / 2(L₋ − 2L_b + L₊): the vertex of the parabola through the three levels, exact for a beam that is
//!    Gaussian. Its height is the detection's amplitude, in dB.

mod accuracy;
mod origins;
mod threshold;

pub use accuracy::estimated_sigma_rad;
pub use origins::{Quality, assign_origins};

use crate::model::angle::wrap;
use crate::model::bearing_time::BearingTimeRecord;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::sensor::SensorSettings;
use crate::registry::{Kind, Object, above, default};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use threshold::{Scale, Threshold};

/// The detector in a request.
pub static DETECTOR: Object = Object {
    name: "Detector",
    summary: "How detections are found in a bearing-time record: peaks of the power, averaged over an interval, above a threshold.",
    fields: &[
        default(
            "threshold",
            "What a cell must exceed.",
            Kind::Union(&threshold::THRESHOLD),
            r#"{"kind":"cell_averaging"}"#,
        ),
        default(
            "every_s",
            "Interval of which each makes one scan of the mean power.",
            above(0.0, 1e6, "s"),
            "10.0",
        ),
        default(
            "gate_deg",
            "Where truth is known: a detection at most this far from a true bearing is that of the target.",
            above(0.0, 90.0, "deg"),
            "2.0",
        ),
    ],
};

/// A detector, as a request describes it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Detector {
    threshold: Threshold,
    every_s: f64,
    pub gate_deg: f64,
}

/// What was found, and with what.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    pub recording: Recording,
    pub tuning: Tuning,
}

/// What the detector took for its threshold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tuning {
    /// Independent values in the power of a cell of the record: given, or estimated from it. `None` where it is not needed.
    pub noise_averages: Option<f64>,
    /// How far a cell of a whole interval must stand out of the mean of its training cells.
    pub threshold_over_mean_db: Option<f64>,
}

impl Detector {
    /// The detections of `record`; `progress(done, total)` is told after each interval and may stop the work (then the result is
    /// `None`).
    ///
    /// # Errors
    /// A threshold whose cells do not fit into the record.
    pub fn detect(
        &self,
        record: &BearingTimeRecord,
        sensor: &SensorSettings,
        progress: &mut dyn FnMut(u64, u64) -> ControlFlow<()>,
    ) -> Result<Option<Found>, Vec<Fault>> {
        let mut scale = Scale::new(&self.threshold, record)?;
        let intervals = self.intervals(record);
        let mut parts = RecordingParts {
            sensors: vec![sensor.clone()],
            ..Default::default()
        };
        let mut power = vec![0.0; record.width()];
        for (index, rows) in intervals.iter().enumerate() {
            average(record, rows.clone(), &mut power);
            let time_s = record.times_s[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
            let thresholds = scale.thresholds(&power, rows.len());
            let detections = peaks(record, &power, thresholds);
            let number = index as u32 + 1;
            let numbers = 1..=detections.len();
            parts
                .detection_ids
                .extend(numbers.map(|index| format!("{number}-{index}")));
            parts.scans.push(Scan {
                number,
                time_s,
                sensor: 0,
                pose: None,
                own: Vec::new(),
                detections,
            });
            if progress(index as u64 + 1, intervals.len() as u64).is_break() {
                return Ok(None);
            }
        }
        let whole = intervals
            .iter()
            .map(ExactSizeIterator::len)
            .max()
            .unwrap_or(1);
        Ok(Some(Found {
            recording: Recording::new(parts)?,
            tuning: scale.tuning(whole),
        }))
    }

    /// The rows of each interval that has any, counted from the first time.
    fn intervals(&self, record: &BearingTimeRecord) -> Vec<std::ops::Range<usize>> {
        // Times that are sums of steps may miss the end of an interval by their rounding.
        let number = |time_s: f64| ((time_s - record.times_s[0]) / self.every_s + 1e-9).floor();
        let mut intervals = Vec::new();
        let mut first = 0;
        for row in 1..=record.times_s.len() {
            if record
                .times_s
                .get(row)
                .is_none_or(|&time_s| number(time_s) > number(record.times_s[first]))
            {
                intervals.push(first..row);
                first = row;
            }
        }
        intervals
    }
}

/// Step 1.
fn average(record: &BearingTimeRecord, rows: std::ops::Range<usize>, power: &mut [f64]) {
    power.fill(0.0);
    let count = rows.len() as f64;
    for row in rows {
        for (sum, &level_db) in power.iter_mut().zip(record.row(row)) {
            *sum += 10f64.powf(f64::from(level_db) / 10.0) / count;
        }
    }
}

/// Steps 2 and 3.
fn peaks(record: &BearingTimeRecord, power: &[f64], thresholds: &[f64]) -> Vec<Detection> {
    let width = power.len();
    let cells = if record.wraps() {
        0..width
    } else {
        1..width - 1
    };
    let found = cells.filter_map(|cell| {
        let (before, after) = ((cell + width - 1) % width, (cell + 1) % width);
        let is_peak = power[cell] > thresholds[cell]
            && power[cell] > power[before]
            && power[cell] >= power[after];
        is_peak.then(|| peak(record, power, [before, cell, after]))
    });
    let mut found: Vec<Detection> = found.collect();
    found.shrink_to_fit();
    found
}

fn peak(record: &BearingTimeRecord, power: &[f64], cells: [usize; 3]) -> Detection {
    let [below, level_db, above] =
        cells.map(|cell| 10.0 * power[cell].max(f64::MIN_POSITIVE).log10());
    let curvature = below - 2.0 * level_db + above;
    // Of a peak it is negative; of two equals and a rounding it may be 0.
    let offset = if curvature < 0.0 {
        0.5 * (below - above) / curvature
    } else {
        0.0
    };
    let bearings = cells.map(|cell| record.bearings_rad[cell]);
    let width_rad = if offset < 0.0 {
        wrap(bearings[1] - bearings[0])
    } else {
        wrap(bearings[2] - bearings[1])
    };
    Detection {
        measurement: Measurement::Bearing {
            bearing_rad: (bearings[1] + offset * width_rad).rem_euclid(TAU),
        },
        origin: None,
        amplitude: Some(level_db - 0.25 * (below - above) * offset),
    }
}

#[cfg(test)]
mod tests;
