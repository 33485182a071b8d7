//! The scene of the preset `coalescence` under its associators, beside the numbers of a program in numpy: how far two tracks are
//! from two targets while these fly side by side and afterwards, and which target each track is at in the end.

use serde_json::Value;
use std::ops::{ControlFlow, Range};
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::experiment::presets;
use trackloom_domain::filtering::AnyFilter;
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scan::Recording;
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::sensor::Sensor;
use trackloom_domain::model::state::{Covariance, GaussianState, State};
use trackloom_domain::model::truth::TruthSet;
use trackloom_domain::model::watch::Watch;
use trackloom_domain::registry;
use trackloom_domain::tracking::{
    Confirmation, GivenTrack, History, Initiation, Lifecycle, TRACKERS, Tracker, TrackerParts,
};

/// Scans in which the targets are 0.8 m apart, and those afterwards.
pub const PARALLEL: Range<usize> = 30..70;
pub const AFTER: Range<usize> = 70..100;

/// A squared distance counts at most so much.
const MOST_M2: f64 = 100.0;

/// In the end a track is at a target when it is this near.
const NEAR_M: f64 = 4.0;

pub const OUTCOMES: [&str; 4] = ["kept", "swapped", "coalesced", "lost"];

/// What the other program found in 300 runs: associator, RMS in parallel and after (m), median of the squares in parallel (m²),
/// shares of the outcomes.
pub const PUBLISHED: [(&str, [f64; 2], f64, [f64; 4]); 4] = [
    (
        "GNN",
        [1.089_347, 1.114_846],
        0.936_080,
        [0.506_667, 0.49, 0.0, 0.003_333],
    ),
    (
        "JPDA",
        [0.800_908, 3.446_295],
        0.477_931,
        [0.703_333, 0.273_333, 0.023_333, 0.0],
    ),
    (
        "JPDA*",
        [1.012_601, 0.953_048],
        0.875_974,
        [0.51, 0.49, 0.0, 0.0],
    ),
    (
        "NN-JPDA",
        [1.089_854, 1.114_846],
        0.937_369,
        [0.51, 0.486_667, 0.0, 0.003_333],
    ),
];

/// Runs of one batch: the spread of the batches tells how sure a median is.
const BATCH: usize = 10;

/// Of all runs of one associator.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// Of each run the mean of the squared errors in parallel and after, m².
    squares: Vec<[f64; 2]>,
    /// How many runs ended in each of [`OUTCOMES`].
    pub outcomes: [u32; 4],
    /// Of each run the squared errors of the scans in parallel, m².
    parallel_m2: Vec<Vec<f64>>,
}

impl Found {
    pub fn runs(&self) -> u32 {
        self.outcomes.iter().sum()
    }

    /// RMS in parallel and after, each with its standard error, m.
    pub fn rms_m(&self) -> [(f64, f64); 2] {
        let runs = f64::from(self.runs());
        [0, 1].map(|part| {
            let values = || self.squares.iter().map(|squares| squares[part]);
            let mean = values().sum::<f64>() / runs;
            let spread = values().map(|value| (value - mean).powi(2)).sum::<f64>();
            let error = (spread / (runs * (runs - 1.0))).sqrt();
            (mean.sqrt(), error / (2.0 * mean.sqrt()))
        })
    }

    /// Median of the squared errors in parallel over runs and scans, with its standard error, m². Needs two batches of runs.
    pub fn median_m2(&self) -> (f64, f64) {
        let medians: Vec<f64> = self.parallel_m2.chunks_exact(BATCH).map(median).collect();
        let count = medians.len() as f64;
        let mean = medians.iter().sum::<f64>() / count;
        let squares = medians.iter().map(|median| (median - mean).powi(2));
        let error = (squares.sum::<f64>() / (count * (count - 1.0))).sqrt();
        (median(&self.parallel_m2), error)
    }

    pub fn shares(&self) -> [f64; 4] {
        self.outcomes
            .map(|count| f64::from(count) / f64::from(self.runs()))
    }
}

fn median(runs: &[Vec<f64>]) -> f64 {
    let mut all = runs.concat();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

/// Name and associator of each cell of the preset.
pub fn associators() -> Vec<(String, Value)> {
    let body = body();
    let variants = body["grid"][0]["variants"].as_array();
    let variants = variants.expect("the preset has variants").iter();
    let named = |variant: &Value| {
        let name = variant["name"].as_str().expect("a variant has a name");
        (name.to_owned(), variant["set"][0]["value"].clone())
    };
    variants.map(named).collect()
}

fn body() -> Value {
    let preset = presets::find("coalescence");
    preset.expect("the preset is in the table").body
}

/// Truth and detections of a run.
pub fn simulated(run: u32) -> (Scenario, TruthSet, Recording) {
    let scenario = body()["base"]["input"]["scenario"].take();
    let scenario: Scenario = serde_json::from_value(scenario).expect("it says all of a scenario");
    let seed = Seed { seed: 1, run };
    let simulated =
        trackloom_domain::simulation::simulate(&scenario, seed, &mut |_| ControlFlow::Continue(()));
    let simulated = simulated
        .expect("the scene is valid")
        .expect("nobody stops it");
    (scenario, simulated.truth, simulated.recording)
}

pub fn found(associator: &Value, runs: u32) -> Found {
    let mut found = Found::default();
    for run in 0..runs {
        add_run(&mut found, associator, run);
    }
    found
}

fn add_run(found: &mut Found, associator: &Value, run: u32) {
    let (scenario, truth, recording) = simulated(run);
    let mut tracker = (TRACKERS[0].build)(parts(&scenario, &truth, associator));
    let mut history = History::default();
    let (mut squares, mut last) = (Vec::new(), [[0.0; 2]; 2]);
    for (index, scan) in recording.scans.iter().enumerate() {
        tracker
            .step(scan, &mut history, &Watch::never())
            .expect("the scene fits");
        last = squared_distances(tracker.as_ref(), &truth, index);
        let capped = last.map(|line| line.map(|square| square.min(MOST_M2)));
        let straight = capped[0][0] + capped[1][1];
        let crossed = capped[0][1] + capped[1][0];
        squares.push(straight.min(crossed) / 2.0);
    }
    let mean = |part: Range<usize>| {
        let count = part.len() as f64;
        squares[part].iter().sum::<f64>() / count
    };
    found.squares.push([mean(PARALLEL), mean(AFTER)]);
    found.parallel_m2.push(squares[PARALLEL].to_vec());
    found.outcomes[outcome(last)] += 1;
}

/// Of each track from each target, m².
fn squared_distances(tracker: &dyn Tracker, truth: &TruthSet, scan: usize) -> [[f64; 2]; 2] {
    let tracks = tracker.tracks();
    [0, 1].map(|track| {
        [0, 1].map(|target| {
            let place = truth.targets()[target].points[scan].position;
            let estimate = &tracks[track].kinematics;
            (estimate[0] - place.x).powi(2) + (estimate[1] - place.y).powi(2)
        })
    })
}

/// Index in [`OUTCOMES`].
fn outcome(squared: [[f64; 2]; 2]) -> usize {
    let near = squared.map(|line| line.map(|square| square < NEAR_M * NEAR_M));
    if near[0][0] && near[1][1] {
        0
    } else if near[0][1] && near[1][0] {
        1
    } else if (near[0][0] && near[1][0]) || (near[0][1] && near[1][1]) {
        2
    } else {
        3
    }
}

fn parts(scenario: &Scenario, truth: &TruthSet, associator: &Value) -> TrackerParts {
    let radar = &scenario.sensors[0];
    let sensor = Sensor {
        sensor_id: radar.sensor_id.clone(),
        p_d: radar.p_d,
        clutter_density: radar.clutter_per_m2().expect("the sensor has a range"),
        may_start: true,
        report: MeasurementModel::Position {
            sigma_x_m: 1.0,
            sigma_y_m: 1.0,
        },
        sight: None,
    };
    let method = ASSOCIATORS
        .iter()
        .find(|method| associator["method"] == method.name);
    let method = method.expect("a name of the table");
    let mut settings = associator.clone();
    if let Some(settings) = settings.as_object_mut() {
        settings.remove("method");
    }
    let checked = registry::check(&settings, method.parameters).expect("they are right");
    let associator = (method.build)(&checked, Seed { seed: 1, run: 0 }).expect("it builds");
    TrackerParts {
        filter: AnyFilter::kalman(0.05),
        associator,
        lifecycle: lifecycle(),
        sensors: vec![sensor],
        undetected: None,
        given: given(truth),
    }
}

fn lifecycle() -> Lifecycle {
    Lifecycle {
        gate_probability: 0.999,
        initiation: Initiation::Truth {
            speed_sigma_mps: 1.0,
            rate_sigma_degps: 1.0,
        },
        confirmation: Confirmation::MOfN,
        confirm_hits: 3,
        confirm_window: 5,
        max_missed: 5,
        max_missed_s: None,
        max_position_sigma_m: None,
        initial_speed_sigma_mps: 1.0,
        smoothing: None,
        merging: None,
    }
}

/// Both tracks at the truth, P = I.
fn given(truth: &TruthSet) -> Vec<GivenTrack> {
    let given = |(index, target): (usize, &trackloom_domain::model::truth::Target)| {
        let (place, velocity) = (target.points[0].position, target.points[0].velocity);
        let velocity = velocity.expect("simulated truth has velocities");
        let mut kinematics = Vec::new();
        let mean = State::new(place.x, place.y, velocity.x, velocity.y);
        let covariance = Covariance::identity();
        GaussianState { mean, covariance }.pack_into(&mut kinematics);
        GivenTrack {
            name: target.truth_id.clone(),
            origin: Some(index as u32),
            kinematics,
        }
    };
    truth.targets().iter().enumerate().map(given).collect()
}
