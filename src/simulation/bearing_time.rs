//! The bearing-time record of a scene of bearings: what a beamformer shows of its targets, of noise and of interference. Each
//! cell has a power of its own, so that a detector meets what it meets at sea: levels that come and go, targets that merge.
//!
//! # Reference
//! R. J. Urick, Principles of Underwater Sound, 3rd edition, 1983, chapters 2 and 12 (levels, detection in averaged noise).
//!
//! # Symbols
//! P(β, t) mean power of a cell over that of the noise; B(δ) = exp(−4 ln 2 δ²/w²) the beam, w its width at half power;
//! L_i(t) level of target i over the noise in dB; M independent values of which the power in a cell is the mean.
//!
//! # Method
//! 1. L_i(t) = L_i + f x(t), x an autoregressive process of variance 1 with the correlation exp(−Δt/τ) from row to row.
//! 2. P = 1 + Σ 10^(L_i/10) B(β − β_i) + Σ sectors + Σ transients, which have the shape of the beam too.
//! 3. The power of the cell is P times a Gamma variable of mean 1 and shape M; its level is 10 log10 of that.
//!
//! The noises of neighbouring cells are independent, which those of overlapping beams are not. 0 dB is the noise.

use super::targets::{self, Path};
use crate::math::rng::{Purpose, Seed};
use crate::model::angle::wrap;
use crate::model::bearing_time::{BearingTimeParts, BearingTimeRecord, MAX_CELLS};
use crate::model::fault::Fault;
use crate::model::scenario::{RecordPlan, Scenario, TargetPlan};
use crate::model::sensor::SensorSettings;
use crate::model::truth::TruthSet;
use crate::registry::{Bound, Kind, Object, default, number, optional, required, whole};
use rand::RngExt;
use rand_distr::{Distribution, Gamma, Poisson, StandardNormal};
use std::f64::consts::{LN_2, TAU};
use std::ops::ControlFlow;

const fn above_zero(max: f64, unit: &'static str) -> Kind {
    Kind::Number {
        min: Bound::Excluding(0.0),
        max: Bound::Including(max),
        unit,
    }
}

const LEVEL: Kind = number(-60.0, 120.0, "dB");
const BEARING: Kind = number(-360.0, 360.0, "deg");

/// [`RecordPlan`] in a request.
pub static RECORD: Object = Object {
    name: "RecordPlan",
    summary: "The bearing-time record of a scene of bearings, in which a detector finds the detections: levels over the noise in cells all round.",
    fields: &[
        default(
            "time_step_s",
            "Time from row to row.",
            above_zero(1e4, "s"),
            "1.0",
        ),
        default(
            "bearing_step_deg",
            "Width of a cell; a whole number of them is a turn.",
            above_zero(90.0, "deg"),
            "1.0",
        ),
        default(
            "beam_width_deg",
            "Width of the beam at half power.",
            above_zero(90.0, "deg"),
            "3.0",
        ),
        default(
            "noise_averages",
            "Independent values of which the power in a cell is the mean.",
            whole(1, 10_000, ""),
            "4",
        ),
        default(
            "levels_db",
            "Mean level of each target over the noise in a cell; one value for all of them.",
            Kind::List {
                item: &LEVEL,
                min: 1,
                max: 20_000,
            },
            "[10.0]",
        ),
        default(
            "fluctuation_db",
            "Standard deviation of a target's level.",
            number(0.0, 30.0, "dB"),
            "2.0",
        ),
        default(
            "fluctuation_time_s",
            "Time in which a level forgets what it was.",
            above_zero(1e6, "s"),
            "30.0",
        ),
        default(
            "sectors",
            "Broad interference that stands still.",
            Kind::List {
                item: &Kind::Object(&SECTOR),
                min: 0,
                max: 100,
            },
            "[]",
        ),
        optional(
            "transients",
            "Short interference from random directions; none when absent.",
            Kind::Object(&TRANSIENTS),
        ),
    ],
};

static SECTOR: Object = Object {
    name: "InterferenceSector",
    summary: "A sector with more noise.",
    fields: &[
        required("centre_deg", "Its middle.", BEARING),
        required("width_deg", "From edge to edge.", above_zero(360.0, "deg")),
        required(
            "level_db",
            "Power that is added in each of its cells, over the noise.",
            LEVEL,
        ),
    ],
};

static TRANSIENTS: Object = Object {
    name: "Transients",
    summary: "Sounds of a Poisson number at uniform times and bearings.",
    fields: &[
        required(
            "per_minute",
            "Mean number of them.",
            above_zero(1e4, "1/min"),
        ),
        default(
            "duration_s",
            "How long each lasts.",
            above_zero(1e6, "s"),
            "3.0",
        ),
        default("level_db", "Level over the noise.", LEVEL, "15.0"),
    ],
};

/// Streams of [`Purpose::BearingTime`]: that of the noise, that of transients, and one a target from the third on.
const NOISE: u64 = 0;
const TRANSIENT: u64 = 1;
const FIRST_TARGET: u64 = 2;

/// A record and what was really there, at each of its times.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRecord {
    pub record: BearingTimeRecord,
    pub truth: TruthSet,
    /// What a tracker is told of the sensor.
    pub sensor: SensorSettings,
}

/// What the table of fields cannot see.
pub(super) fn faults(scenario: &Scenario, plan: &RecordPlan) -> Vec<Fault> {
    let mut faults = Vec::new();
    if !matches!(scenario.targets, TargetPlan::Bearings(_)) {
        let fault = Fault::new(
            "/record",
            "conflict",
            "a bearing-time record is made of targets of the kind bearings",
        );
        faults.push(fault.allowing("targets of the kind bearings"));
    }
    for (index, sensor) in scenario.sensors.iter().enumerate().skip(1) {
        let detail = format!(
            "a bearing-time record is that of one sensor; '{}' is another",
            sensor.sensor_id
        );
        faults.push(
            Fault::new(format!("/sensors/{index}"), "conflict", detail).allowing("one sensor"),
        );
    }
    if scenario.coverage.is_some() {
        faults.push(
            Fault::new(
                "/coverage",
                "conflict",
                "a bearing-time record shows all targets",
            )
            .allowing("no coverage"),
        );
    }
    let cells = 360.0 / plan.bearing_step_deg;
    if (cells - cells.round()).abs() > 1e-6 {
        let detail = format!("{} degrees are {cells} cells a turn", plan.bearing_step_deg);
        faults.push(
            Fault::new("/record/bearing_step_deg", "out_of_range", detail)
                .allowing("360 divided by a whole number"),
        );
    }
    let targets = scenario.targets.count();
    if plan.levels_db.len() != 1 && plan.levels_db.len() != targets {
        let detail = format!(
            "there are {} levels for {targets} targets",
            plan.levels_db.len()
        );
        faults.push(
            Fault::new("/record/levels_db", "conflict", detail)
                .allowing(format!("1 or {targets} values")),
        );
    }
    if rows(scenario, plan) * cells > MAX_CELLS as f64 {
        let fault = Fault::new(
            "/record",
            "too_large",
            format!("the record has {:.0} cells", rows(scenario, plan) * cells),
        );
        faults.push(fault.allowing(format!("<= {MAX_CELLS} cells")));
    }
    faults
}

/// The record lasts as long as the scans of the scenario do.
fn rows(scenario: &Scenario, plan: &RecordPlan) -> f64 {
    // Of 0.3 s in steps of 0.1 s, too, there are three.
    (f64::from(scenario.scans) * scenario.scan_period_s / plan.time_step_s + 1e-9)
        .floor()
        .max(1.0)
}

/// Simulates the record of `scenario`; `progress(done)` is told after each row, of as many as [`row_count`] says, and may stop
/// the work (then the result is `None`).
///
/// # Errors
/// Those of [`super::check`], and a scenario without a record.
pub fn simulate_record(
    scenario: &Scenario,
    seed: Seed,
    progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Result<Option<SimulatedRecord>, Vec<Fault>> {
    super::check(scenario)?;
    let (Some(plan), Some(sensor)) = (&scenario.record, scenario.sensors.first()) else {
        return Err(vec![Fault::new(
            "/record",
            "missing",
            "the scenario has no bearing-time record",
        )]);
    };
    let times_s: Vec<f64> = (0..row_count(scenario, plan))
        .map(|row| row as f64 * plan.time_step_s)
        .collect();
    let paths = targets::paths(scenario, seed);
    let mut scene = RecordScene::new(plan, &paths, &times_s, seed);
    let mut levels_db = Vec::with_capacity(times_s.len() * scene.bearings_rad.len());
    for (row, &time_s) in times_s.iter().enumerate() {
        scene.add_row(row as u64, time_s, &mut levels_db);
        if progress(row as u64 + 1).is_break() {
            return Ok(None);
        }
    }
    let targets = paths.iter().map(|path| path.truth_at(&times_s)).collect();
    let truth = TruthSet::new(scenario.targets.space(), targets)?;
    let bearings_rad = scene.bearings_rad;
    let record = BearingTimeRecord::new(BearingTimeParts {
        times_s,
        bearings_rad,
        levels_db,
    })?;
    // What is not stated is not known: the detector, not the scenario, makes the false detections.
    let clutter_per_deg = sensor
        .clutter_per_deg
        .or(sensor.clutter_per_scan.map(|per_scan| per_scan / 360.0));
    let sensor = SensorSettings {
        clutter_per_deg,
        clutter_per_m2: None,
        ..super::sensors::settings(sensor)
    };
    Ok(Some(SimulatedRecord {
        record,
        truth,
        sensor,
    }))
}

/// Rows of the record.
pub fn row_count(scenario: &Scenario, plan: &RecordPlan) -> u64 {
    rows(scenario, plan) as u64
}

/// A sound from one direction.
struct Transient {
    start_s: f64,
    bearing_rad: f64,
}

struct RecordScene<'a> {
    plan: &'a RecordPlan,
    paths: &'a [Path],
    bearings_rad: Vec<f64>,
    /// Noise and sectors.
    background: Vec<f64>,
    transients: Vec<Transient>,
    /// x of each target.
    fluctuations: Vec<f64>,
    seed: Seed,
    /// Reused from row to row.
    power: Vec<f64>,
}

fn from_db(level_db: f64) -> f64 {
    10f64.powf(level_db / 10.0)
}

impl<'a> RecordScene<'a> {
    fn new(plan: &'a RecordPlan, paths: &'a [Path], times_s: &[f64], seed: Seed) -> Self {
        let cells = (360.0 / plan.bearing_step_deg).round() as usize;
        let bearings_rad: Vec<f64> = (0..cells)
            .map(|cell| (cell as f64 * plan.bearing_step_deg).to_radians())
            .collect();
        let background = |&bearing_rad: &f64| {
            let within = plan.sectors.iter().filter(|sector| {
                wrap(bearing_rad - sector.centre_deg.to_radians()).abs()
                    <= sector.width_deg.to_radians() / 2.0
            });
            1.0 + within.map(|sector| from_db(sector.level_db)).sum::<f64>()
        };
        let background: Vec<f64> = bearings_rad.iter().map(background).collect();
        let fluctuations = vec![0.0; paths.len()];
        let duration_s = times_s.len() as f64 * plan.time_step_s;
        let transients = transients(plan, duration_s, seed);
        RecordScene {
            plan,
            paths,
            power: background.clone(),
            background,
            bearings_rad,
            transients,
            fluctuations,
            seed,
        }
    }

    fn add_row(&mut self, row: u64, time_s: f64, levels_db: &mut Vec<f32>) {
        self.power.clone_from(&self.background);
        for index in 0..self.paths.len() {
            let level_db = self.target_level_db(index, row);
            let bearing_rad = self.paths[index].point_at(time_s).position.x;
            self.add_beam(bearing_rad, from_db(level_db));
        }
        if let Some(kind) = self.plan.transients {
            for index in 0..self.transients.len() {
                let Transient {
                    start_s,
                    bearing_rad,
                } = self.transients[index];
                if (start_s..start_s + kind.duration_s).contains(&time_s) {
                    self.add_beam(bearing_rad, from_db(kind.level_db));
                }
            }
        }
        let averages = f64::from(self.plan.noise_averages);
        let noise = Gamma::new(averages, 1.0 / averages).expect("a shape of 1 at least is one");
        let mut draw = self.seed.stream(Purpose::BearingTime, NOISE, row);
        levels_db.extend(
            self.power.iter().map(|power| {
                (10.0 * (power * noise.sample(&mut draw)).log10()).max(LEAST_DB) as f32
            }),
        );
    }

    /// L(t) of step 1.
    fn target_level_db(&mut self, index: usize, row: u64) -> f64 {
        let error: f64 = StandardNormal.sample(&mut self.seed.stream(
            Purpose::BearingTime,
            FIRST_TARGET + index as u64,
            row,
        ));
        let kept = if row == 0 {
            0.0
        } else {
            (-self.plan.time_step_s / self.plan.fluctuation_time_s).exp()
        };
        let value = &mut self.fluctuations[index];
        *value = kept * *value + (1.0 - kept * kept).sqrt() * error;
        let level_db = self
            .plan
            .levels_db
            .get(index)
            .unwrap_or(&self.plan.levels_db[0]);
        level_db + self.plan.fluctuation_db * *value
    }

    fn add_beam(&mut self, bearing_rad: f64, power: f64) {
        let width_rad = self.plan.beam_width_deg.to_radians();
        for (cell, &cell_rad) in self.power.iter_mut().zip(&self.bearings_rad) {
            *cell +=
                power * (-4.0 * LN_2 * (wrap(cell_rad - bearing_rad) / width_rad).powi(2)).exp();
        }
    }
}

/// The level of a power that rounding or chance has made zero.
const LEAST_DB: f64 = -300.0;

fn transients(plan: &RecordPlan, duration_s: f64, seed: Seed) -> Vec<Transient> {
    let Some(Ok(count)) = plan
        .transients
        .map(|kind| Poisson::new(kind.per_minute / 60.0 * duration_s))
    else {
        return Vec::new();
    };
    let mut draw = seed.stream(Purpose::BearingTime, TRANSIENT, 0);
    let number = count.sample(&mut draw) as u64;
    (0..number)
        .map(|_| Transient {
            start_s: duration_s * draw.random::<f64>(),
            bearing_rad: TAU * draw.random::<f64>(),
        })
        .collect()
}

#[cfg(test)]
mod tests;
