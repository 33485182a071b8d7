//! How fast targets are, told from detections alone: three detections of successive scans of a sensor that lie on one straight
//! course are more often of one target than they are not. Truth and origins are never looked at.
//!
//! # Symbols
//! a, b, c detections of three successive scans of a sensor; T₁, T₂ the times between them, ρ = T₂ / T₁; d = b − a; σ² the larger
//! variance of a detection's coordinates; γ the 99 % threshold of a squared distance in the plane.
//!
//! # Method
//! 1. Detections that repeat are left out, for they are slow or no target: an `a` with a detection of the next scan, and a `b` with
//!    one of the scan before, within √(γ · 2 σ²). What moves less than that in a scan needs no speed beyond that of the noise.
//! 2. For each pair (a, b) the gates γ · σ² (1 + (1 + ρ)² + ρ²) around b + ρ d and around b − ρ d: the first holds the next
//!    detection of a target, both hold the same clutter, also where that lies on a line.
//! 3. The speeds |d| / T₁ are counted in a ladder of half octaves. A rung is believed where the gates onwards have clearly more
//!    detections than those backwards; the highest rung that is believed is that of the fastest targets.
//!
//! At most [`MOST_TRIPLES`] triples of scans are looked at, evenly spread, and about [`MOST_PAIRS`] pairs, the near ones where there
//! are more; the same data give the same answer.

use crate::experiment::input::extent::place_of;
use crate::gating::grid::Grid;
use crate::math::gaussian::gate_threshold;
use crate::model::scan::{Recording, Scan};
use crate::model::sensing::{MeasurementModel, Moving};
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::state::Position;

const MOST_TRIPLES: usize = 200;
const MOST_PAIRS: usize = 500_000;
/// Detections of one scan that are looked at.
const MOST_OF_A_SCAN: usize = 20_000;
/// Detections of all triples together.
const MOST_DETECTIONS: usize = 2_000_000;
/// Rungs of half an octave from 1/16 m/s on.
const RUNGS: usize = 64;
const LOWEST_RUNG: f64 = 16.0;
const GATE_PROBABILITY: f64 = 0.99;
/// What is assumed to be the highest speed where nothing can be seen.
const ORDINARY_MPS: f64 = 25.0;

/// What is seen of the speeds of a recording's targets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApparentSpeed {
    /// Mean speed on the highest believed rung; `None` where nothing moves clearly more than the noise.
    pub fastest_mps: Option<f64>,
    /// σ / T₁, the middle one of all triples of scans: a speed that noise alone looks like.
    pub noise_mps: f64,
    /// Whether clutter would hide a target of [`ORDINARY_MPS`], or too few scans show it.
    pub is_hidden: bool,
}

/// A detection of a sensor that is looked at.
#[derive(Debug, Clone, Copy)]
struct Seen {
    place_m: Position,
    /// σ².
    variance_m2: f64,
}

/// The detections of one scan, ready to be looked up.
struct Look {
    time_s: f64,
    seen: Vec<Seen>,
    grid: Grid,
    largest_variance_m2: f64,
}

/// A rung of the ladder.
#[derive(Debug, Clone, Copy, Default)]
struct Rung {
    /// Gates onwards, and backwards, that hold a detection.
    onwards: f64,
    backwards: f64,
    /// Of those onwards.
    speeds_mps: f64,
}

/// The speeds that are seen in a recording; `None` where no sensor of places has three scans with detections in a row.
pub fn apparent_speed(
    recording: &Recording,
    known: &[SensorSettings],
    sensors: &[Sensor],
) -> Option<ApparentSpeed> {
    let triples = triples_of(recording, sensors);
    let pairs_each = MOST_PAIRS / triples.len().max(1);
    let (mut ladder, mut noises_mps) = ([Rung::default(); RUNGS], Vec::new());
    for scans in &triples {
        let sensor = scans[0].sensor;
        let looks = scans.map(|scan| Look::new(scan, &known[sensor], &sensors[sensor]));
        let period_s = looks[1].time_s - looks[0].time_s;
        let mean_variance_m2 = looks[0]
            .seen
            .iter()
            .map(|seen| seen.variance_m2)
            .sum::<f64>()
            / looks[0].seen.len().max(1) as f64;
        if period_s > 0.0 && mean_variance_m2 > 0.0 {
            noises_mps.push(mean_variance_m2.sqrt() / period_s);
            climb(&looks, pairs_each, &mut ladder);
        }
    }
    noises_mps.sort_by(f64::total_cmp);
    let noise_mps = *noises_mps.get(noises_mps.len() / 2)?;
    let fastest_mps = highest(&ladder, triples.len());
    Some(ApparentSpeed {
        fastest_mps,
        noise_mps,
        is_hidden: is_hidden(&ladder, triples.len(), ORDINARY_MPS),
    })
}

/// Successive scans of one sensor of places, of each sensor, evenly thinned out.
fn triples_of<'a>(recording: &'a Recording, sensors: &[Sensor]) -> Vec<[&'a Scan; 3]> {
    let mut scans_of: Vec<Vec<&Scan>> = vec![Vec::new(); sensors.len()];
    for scan in &recording.scans {
        scans_of[scan.sensor].push(scan);
    }
    let mut triples = Vec::new();
    for (scans, _) in scans_of
        .iter()
        .zip(sensors)
        .filter(|(_, sensor)| !sensor.report.is_bearing())
    {
        let in_a_row = scans.windows(3).map(|three| [three[0], three[1], three[2]]);
        triples
            .extend(in_a_row.filter(|three| three.iter().all(|scan| !scan.detections.is_empty())));
    }
    let detections: usize = triples
        .iter()
        .flatten()
        .map(|scan| scan.detections.len().min(MOST_OF_A_SCAN))
        .sum();
    let enough = (triples.len() * MOST_DETECTIONS / detections.max(1)).clamp(8, MOST_TRIPLES);
    let step = triples.len().div_ceil(enough).max(1);
    triples.into_iter().step_by(step).collect()
}

impl Look {
    fn new(scan: &Scan, settings: &SensorSettings, sensor: &Sensor) -> Look {
        let report = sensor.report_in(scan);
        let place_m = report.place_m().unwrap_or_else(|| place_of(settings));
        let mut seen = Vec::new();
        for detection in scan.detections.iter().take(MOST_OF_A_SCAN) {
            let Some(at_m) = detection.measurement.position_seen_from(&place_m) else {
                continue;
            };
            seen.push(Seen {
                place_m: at_m,
                variance_m2: variance_m2(&report, &at_m),
            });
        }
        let places: Vec<[f64; 2]> = seen.iter().map(|seen| seen.place_m.into()).collect();
        let mut grid = Grid::default();
        grid.rebuild(&places);
        let largest_variance_m2 = seen.iter().map(|seen| seen.variance_m2).fold(0.0, f64::max);
        Look {
            time_s: scan.time_s,
            seen,
            grid,
            largest_variance_m2,
        }
    }

    /// Detections within the gate of a place that is known with this variance, to which their own is added.
    fn count(&self, centre_m: &Position, variance_m2: f64) -> usize {
        let threshold = gate_threshold(GATE_PROBABILITY, 2);
        let reach_m = (threshold * (variance_m2 + self.largest_variance_m2)).sqrt();
        let mut found = 0;
        self.grid.near(centre_m, [reach_m; 2], None, |index| {
            let seen = &self.seen[index as usize];
            let squared_m2 = (seen.place_m - centre_m).norm_squared();
            found += usize::from(squared_m2 <= threshold * (variance_m2 + seen.variance_m2));
        });
        found
    }

    /// Those without a detection of the other scan at the same place.
    fn gone_from(&self, other: &Look) -> Vec<Seen> {
        self.seen
            .iter()
            .filter(|seen| other.count(&seen.place_m, seen.variance_m2) == 0)
            .copied()
            .collect()
    }
}

/// The larger variance of a coordinate.
fn variance_m2(report: &MeasurementModel, at_m: &Position) -> f64 {
    match *report {
        MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        } => sigma_x_m.max(sigma_y_m).powi(2),
        MeasurementModel::Polar(polar) | MeasurementModel::Converted(polar) => polar
            .sigma_range_m
            .max((at_m - polar.place_m).norm() * polar.sigma_bearing_rad)
            .powi(2),
        MeasurementModel::Position3 { sigmas_m, .. }
        | MeasurementModel::Moving(Moving { sigmas_m, .. }) => sigmas_m[0].max(sigmas_m[1]).powi(2),
        MeasurementModel::Spherical(spherical)
        | MeasurementModel::ConvertedSpherical(spherical) => {
            let away_m = (at_m - spherical.site.place_m.xy()).norm();
            let across_m = away_m * spherical.sigma_bearing_rad;
            spherical.sigma_range_m.max(across_m).powi(2)
        }
        MeasurementModel::Bearing(_) | MeasurementModel::Sight(_) => 0.0,
    }
}

/// Steps 1 to 3 for one triple of scans.
fn climb([first, second, third]: &[Look; 3], most_pairs: usize, ladder: &mut [Rung; RUNGS]) {
    let (starts, ends) = (first.gone_from(second), second.gone_from(first));
    let (before_s, after_s) = (second.time_s - first.time_s, third.time_s - second.time_s);
    let ratio = after_s / before_s;
    let places: Vec<[f64; 2]> = ends.iter().map(|seen| seen.place_m.into()).collect();
    let mut grid = Grid::default();
    grid.rebuild(&places);
    let reach_m = reach_m(&starts, &ends, most_pairs);
    let mut left = 4 * most_pairs;
    for a in &starts {
        grid.near(&a.place_m, [reach_m; 2], None, |index| {
            let b = &ends[index as usize];
            let step_m = b.place_m - a.place_m;
            if left == 0 || step_m.norm() > reach_m {
                return;
            }
            left -= 1;
            let onwards_m = step_m * ratio;
            let variance_m2 = b.variance_m2 * (1.0 + ratio).powi(2) + a.variance_m2 * ratio * ratio;
            let in_gate = |offset_m: Position| {
                if third.count(&(b.place_m + offset_m), variance_m2) > 0 {
                    1.0
                } else {
                    0.0
                }
            };
            let (onwards, backwards) = (in_gate(onwards_m), in_gate(-onwards_m));
            let speed_mps = step_m.norm() / before_s;
            let rung = &mut ladder[rung_of(speed_mps)];
            rung.onwards += onwards;
            rung.backwards += backwards;
            rung.speeds_mps += onwards * speed_mps;
        });
    }
}

/// How far apart two detections are at most, so that about `most_pairs` pairs are looked at: all of them where there are few, else
/// the near ones, for speeds that are too high for the density cannot be told from chance anyway.
fn reach_m(starts: &[Seen], ends: &[Seen], most_pairs: usize) -> f64 {
    let bound = |axis: usize, start: f64, pick: fn(f64, f64) -> f64| {
        starts
            .iter()
            .chain(ends)
            .map(|seen| seen.place_m[axis])
            .fold(start, pick)
    };
    let side_m = |axis: usize| {
        (bound(axis, f64::NEG_INFINITY, f64::max) - bound(axis, f64::INFINITY, f64::min)).max(1.0)
    };
    let (width_m, height_m) = (side_m(0), side_m(1));
    let pairs = (starts.len() * ends.len()).max(1) as f64;
    let share = most_pairs as f64 / pairs;
    if share >= 1.0 {
        width_m.hypot(height_m)
    } else {
        (share * width_m * height_m / std::f64::consts::PI).sqrt()
    }
}

fn rung_of(speed_mps: f64) -> usize {
    (2.0 * (speed_mps * LOWEST_RUNG).max(1.0).log2())
        .floor()
        .min(RUNGS as f64 - 1.0) as usize
}

impl Rung {
    fn surplus(&self) -> f64 {
        self.onwards - self.backwards
    }

    /// By chance a gate of either kind holds the detection: the surplus is at least four standard deviations of that.
    fn is_clear(&self) -> bool {
        self.surplus() >= 4.0 * (self.onwards + self.backwards).sqrt() && self.onwards > 0.0
    }
}

/// The mean speed of the highest rung that is believed: it is clear, and has a hundredth of all surplus at least. Where hardly any
/// gate backwards holds anything there is no chance to mistake, and a tenth of a handful is believed.
fn highest(ladder: &[Rung; RUNGS], triples: usize) -> Option<f64> {
    let total: f64 = ladder
        .iter()
        .map(Rung::surplus)
        .filter(|surplus| *surplus > 0.0)
        .sum();
    let (onwards, backwards) = ladder
        .iter()
        .fold((0.0, 0.0), |(onwards, backwards), rung| {
            (onwards + rung.onwards, backwards + rung.backwards)
        });
    let clear = ladder
        .iter()
        .rfind(|rung| rung.is_clear() && rung.surplus() >= total / 100.0);
    let is_clean = backwards <= onwards / 10.0 && onwards >= (triples as f64).min(3.0);
    let clean = ladder
        .iter()
        .filter(|_| is_clean)
        .rfind(|rung| rung.onwards > rung.backwards && rung.surplus() >= total / 10.0);
    clear.or(clean).map(|rung| rung.speeds_mps / rung.onwards)
}

/// Whether chance would hide a target of this speed that is seen in every triple, or two that are in half of them.
fn is_hidden(ladder: &[Rung; RUNGS], triples: usize, speed_mps: f64) -> bool {
    let rung = &ladder[rung_of(speed_mps)];
    let with_target = Rung {
        onwards: rung.backwards + triples as f64,
        ..*rung
    };
    !with_target.is_clear()
}

#[cfg(test)]
mod tests;
