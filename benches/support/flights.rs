//! Scenes of 30 targets that fly so close together that their gates hold each other's detections: what JPDA is for. Every
//! track is there from the start, so that a run is association alone.

use std::ops::ControlFlow;
use trackloom_domain::association::Associator;
use trackloom_domain::filtering::AnyFilter;
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scan::Recording;
use trackloom_domain::model::scenario::{ListedTarget, Scenario, ScenarioSensor, TargetPlan};
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::sensor::Sensor;
use trackloom_domain::model::state::{Covariance, GaussianState, State};
use trackloom_domain::model::watch::Watch;
use trackloom_domain::tracking::{
    Confirmation, GivenTrack, History, Initiation, Lifecycle, TRACKERS, Tracker, TrackerParts,
};

const SIGMA_M: f64 = 10.0;
const P_D: f64 = 0.9;

pub struct Flights {
    pub name: &'static str,
    targets: Vec<ListedTarget>,
    clutter_per_m2: f64,
    recording: Recording,
}

/// Flights side by side, their targets in rows and columns; one false detection a scan in each square of such a side.
#[derive(Clone, Copy)]
struct Formation {
    flights: u32,
    columns: u32,
    rows: u32,
    spacing_m: f64,
    clutter_square_m: f64,
}

/// Three flights of ten in line abreast, and five of six in two rows of three.
pub fn scenes() -> [Flights; 2] {
    let line = Formation {
        flights: 3,
        columns: 10,
        rows: 1,
        spacing_m: 45.0,
        clutter_square_m: 250.0,
    };
    let block = Formation {
        flights: 5,
        columns: 3,
        rows: 2,
        spacing_m: 20.0,
        clutter_square_m: 120.0,
    };
    [
        Flights::new("in line", line),
        Flights::new("in blocks", block),
    ]
}

impl Flights {
    /// Flights one beside the other, 1 km apart, all on one course across their lines; thirty scans by a sensor of 10 m.
    fn new(name: &'static str, formation: Formation) -> Self {
        let Formation {
            flights,
            columns,
            rows,
            spacing_m,
            ..
        } = formation;
        let places = (0..flights).flat_map(|flight| {
            (0..rows).flat_map(move |row| (0..columns).map(move |column| (flight, row, column)))
        });
        let target = |(flight, row, column): (u32, u32, u32)| ListedTarget {
            z_m: None,
            vz_mps: None,
            truth_id: format!("{flight}-{row}-{column}"),
            x_m: 1000.0 * (f64::from(flight) - f64::from(flights - 1) / 2.0)
                + spacing_m * f64::from(column),
            y_m: spacing_m * f64::from(row) - 900.0,
            vx_mps: 0.0,
            vy_mps: 30.0,
        };
        let targets: Vec<ListedTarget> = places.map(target).collect();
        let scenario = scenario(&targets, formation.clutter_square_m);
        let clutter_per_m2 = scenario.sensors[0]
            .clutter_per_m2()
            .expect("the sensor has a range");
        let simulated = trackloom_domain::simulation::simulate(
            &scenario,
            Seed { seed: 1, run: 0 },
            &mut |_| ControlFlow::Continue(()),
        );
        let recording = simulated
            .expect("the scene is valid")
            .expect("nobody stops it")
            .recording;
        Flights {
            name,
            targets,
            clutter_per_m2,
            recording,
        }
    }

    /// Tracks all targets to the end.
    pub fn tracked(&self, associator: Box<dyn Associator>) -> (Box<dyn Tracker>, History) {
        let mut tracker = (TRACKERS[0].build)(self.parts(associator));
        let mut history = History::default();
        for scan in &self.recording.scans {
            tracker
                .step(scan, &mut history, &Watch::never())
                .expect("the scene fits");
        }
        (tracker, history)
    }

    fn given(&self) -> Vec<GivenTrack> {
        let variances = [SIGMA_M, SIGMA_M, 1.0, 1.0].map(|sigma: f64| sigma * sigma);
        let covariance = Covariance::from_diagonal(&State::from(variances));
        let given = |(target, listed): (usize, &ListedTarget)| {
            let mean = State::new(listed.x_m, listed.y_m, listed.vx_mps, listed.vy_mps);
            let mut kinematics = Vec::new();
            GaussianState { mean, covariance }.pack_into(&mut kinematics);
            GivenTrack {
                name: listed.truth_id.clone(),
                origin: Some(target as u32),
                kinematics,
            }
        };
        self.targets.iter().enumerate().map(given).collect()
    }

    fn parts(&self, associator: Box<dyn Associator>) -> TrackerParts {
        let lifecycle = Lifecycle {
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
        };
        let report = MeasurementModel::Position {
            sigma_x_m: SIGMA_M,
            sigma_y_m: SIGMA_M,
        };
        let sensor = Sensor {
            sensor_id: "radar".into(),
            p_d: P_D,
            clutter_density: self.clutter_per_m2,
            may_start: true,
            report,
            sight: None,
        };
        TrackerParts {
            filter: AnyFilter::kalman(1.0),
            associator,
            lifecycle,
            sensors: vec![sensor],
            undetected: None,
            given: self.given(),
        }
    }
}

fn scenario(targets: &[ListedTarget], clutter_square_m: f64) -> Scenario {
    let max_range_m = 3_000.0;
    let sensor = ScenarioSensor {
        in_space: Default::default(),
        sight: Default::default(),
        timing: Default::default(),
        lat_deg: None,
        lon_deg: None,
        sensor_id: "radar".into(),
        x_m: 0.0,
        y_m: 0.0,
        course: None,
        max_range_m: Some(max_range_m),
        p_d: P_D,
        sigma_x_m: Some(SIGMA_M),
        sigma_y_m: Some(SIGMA_M),
        sigma_range_m: None,
        sigma_bearing_deg: None,
        sigma_range_rate_mps: None,
        clutter_per_scan: Some(
            std::f64::consts::PI * max_range_m * max_range_m
                / (clutter_square_m * clutter_square_m),
        ),
        clutter_dispersion: None,
        clutter_per_deg: None,
        clutter_within_deg: None,
        snr_db: None,
    };
    let targets = TargetPlan::Listed {
        targets: targets.to_vec(),
    };
    Scenario {
        origin: None,
        scans: 30,
        scan_period_s: 2.0,
        sensors: vec![sensor],
        targets,
        coverage: None,
        record: None,
    }
}
