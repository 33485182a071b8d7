//! A tracker that has seen its scene does not allocate: neither for a detection nor for a scan. Only its history grows,
//! in pieces that are the larger the longer it is, so that a hundred scans cost a handful of allocations.

use serde_json::json;
use std::alloc::{GlobalAlloc, Layout, System};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::filtering::{AnyFilter, FILTERS};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scan::{Recording, RecordingParts};
use trackloom_domain::model::scenario::{ListedTarget, Scenario, ScenarioSensor, TargetPlan};
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::sensor::Sensor;
use trackloom_domain::model::watch::Watch;
use trackloom_domain::registry;
use trackloom_domain::tracking::{
    Confirmation, History, Initiation, Lifecycle, TRACKERS, TrackerParts,
};

/// Counts every request for memory.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is handed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc` or `realloc` above, which are the system's.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the pointer came from `alloc` or `realloc` above, which are the system's.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

const WARM_UP: usize = 60;
const COUNTED: usize = 100;

/// What [`COUNTED`] scans may cost, however many detections they have: the history begins a new piece now and then, and a
/// buffer grows when a scan is the fullest so far.
const MOST_ALLOCATIONS: u64 = 16;

/// A piece of the history has one list more, of the probabilities of models.
const MOST_ALLOCATIONS_OF_MODELS: u64 = 24;

#[test]
fn a_hundred_scans_of_any_size_cost_a_handful_of_allocations() {
    for side in [3, 10] {
        let (scenario, recording) = scene(side);
        let detections: usize = recording.scans[WARM_UP..]
            .iter()
            .map(|scan| scan.detections.len())
            .sum();
        assert!(detections > 100 * (side * side) as usize);
        for method in ASSOCIATORS {
            for (filter, most) in [
                (AnyFilter::kalman(0.1), MOST_ALLOCATIONS),
                (several_models(), MOST_ALLOCATIONS_OF_MODELS),
            ] {
                let found = allocations(filter, method.name, &scenario, &recording);
                assert!(
                    found <= most,
                    "{}, {filter:?}: {found} allocations for {detections} detections",
                    method.name
                );
            }
        }
    }
}

/// A lattice of `side` × `side` targets that drift together, so close that gates overlap, in clutter.
fn scene(side: u32) -> (Scenario, Recording) {
    let target = |index: u32| ListedTarget {
        z_m: None,
        vz_mps: None,
        truth_id: (index + 1).to_string(),
        x_m: f64::from(index % side) * 60.0,
        y_m: f64::from(index / side) * 60.0,
        vx_mps: 1.0,
        vy_mps: 0.5,
    };
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
        max_range_m: Some(2_000.0),
        p_d: 0.9,
        sigma_x_m: Some(10.0),
        sigma_y_m: Some(10.0),
        sigma_range_m: None,
        sigma_bearing_deg: None,
        sigma_range_rate_mps: None,
        clutter_per_scan: Some(f64::from(side * side) / 2.0),
        clutter_dispersion: None,
        clutter_per_deg: None,
        clutter_within_deg: None,
        snr_db: None,
    };
    let targets = TargetPlan::Listed {
        targets: (0..side * side).map(target).collect(),
    };
    let scenario = Scenario {
        origin: None,
        scans: (WARM_UP + COUNTED) as u32,
        scan_period_s: 2.0,
        sensors: vec![sensor],
        targets,
        coverage: None,
        record: None,
    };
    let simulated =
        trackloom_domain::simulation::simulate(&scenario, Seed { seed: 1, run: 0 }, &mut |_| {
            ControlFlow::Continue(())
        });
    let recording = simulated.unwrap().unwrap().recording;
    (scenario, with_amplitudes(recording))
}

/// Every detection as strong as its place in the list says.
fn with_amplitudes(recording: Recording) -> Recording {
    let mut parts: RecordingParts = recording.into_parts();
    let detections = parts.scans.iter_mut().flat_map(|scan| &mut scan.detections);
    for (index, detection) in detections.enumerate() {
        detection.amplitude = Some((index * 7919 % 1000) as f64);
    }
    Recording::new(parts).unwrap()
}

/// Constant velocity beside constant acceleration.
fn several_models() -> AnyFilter {
    let models = json!([
        {"model": "constant_velocity", "process_noise_m2ps3": 0.1},
        {"model": "constant_acceleration"}
    ]);
    let imm = FILTERS.iter().find(|filter| filter.name == "imm").unwrap();
    let checked = registry::check(&json!({"models": models}), imm.parameters).unwrap();
    (imm.build)(&checked).unwrap()
}

/// Requests for memory in the last [`COUNTED`] scans.
fn allocations(filter: AnyFilter, method: &str, scenario: &Scenario, recording: &Recording) -> u64 {
    let mut tracker = (TRACKERS[0].build)(parts(filter, method, scenario));
    let mut history = History::default();
    for scan in &recording.scans[..WARM_UP] {
        tracker.step(scan, &mut history, &Watch::never()).unwrap();
    }
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    for scan in &recording.scans[WARM_UP..] {
        let outcome = tracker.step(scan, &mut history, &Watch::never()).unwrap();
        assert!(outcome.confirmed > 0);
    }
    ALLOCATIONS.load(Ordering::Relaxed) - before
}

fn parts(filter: AnyFilter, method: &str, scenario: &Scenario) -> TrackerParts {
    let associator = ASSOCIATORS
        .iter()
        .find(|entry| entry.name == method)
        .unwrap();
    let defaults = registry::check(&json!({}), associator.parameters).unwrap();
    let sensor = &scenario.sensors[0];
    TrackerParts {
        filter,
        associator: (associator.build)(&defaults, Seed { seed: 1, run: 0 }).unwrap(),
        lifecycle: Lifecycle {
            gate_probability: 0.999,
            initiation: Initiation::OnePoint,
            confirmation: Confirmation::MOfN,
            confirm_hits: 3,
            confirm_window: 5,
            max_missed: 5,
            max_missed_s: None,
            max_position_sigma_m: None,
            initial_speed_sigma_mps: 5.0,
            smoothing: None,
            merging: None,
        },
        sensors: vec![Sensor {
            sensor_id: "radar".into(),
            p_d: sensor.p_d,
            clutter_density: sensor.clutter_per_m2().unwrap(),
            may_start: true,
            report: MeasurementModel::Position {
                sigma_x_m: 10.0,
                sigma_y_m: 10.0,
            },
            sight: None,
        }],
        undetected: None,
        given: Vec::new(),
    }
}
