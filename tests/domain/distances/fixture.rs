//! Scenes written as tables, and metrics by name, through the same tables that a request goes through.

use serde_json::Value;
use trackloom_domain::evaluation::EvaluationInput;
use trackloom_domain::evaluation::comparison::{Comparison, PointSettings};
use trackloom_domain::evaluation::credit::Credit;
use trackloom_domain::evaluation::events::EventLog;
use trackloom_domain::evaluation::metrics::{METRIC, METRICS, Metric, MetricReport, Sequence};
use trackloom_domain::evaluation::paths::Alignment;
use trackloom_domain::evaluation::steps::StepSettings;
use trackloom_domain::model::space::Space;
use trackloom_domain::model::state::upper_triangle;
use trackloom_domain::model::state::{Covariance, Position, State};
use trackloom_domain::model::track::{Kinematics, Track, TrackPoint, TrackSet};
use trackloom_domain::model::truth::{Target, TruthPoint, TruthSet};
use trackloom_domain::registry::{Kind, check_field};

static ANY: Kind = Kind::Union(&METRIC);

/// Time, id, x, y, vx, vy.
pub type Row<'a> = (f64, &'a str, f64, f64, f64, f64);

pub struct Scene {
    pub truth: TruthSet,
    pub tracks: TrackSet,
    pub steps: StepSettings,
}

impl Scene {
    pub fn new(truth: &[Row], tracks: &[Row]) -> Scene {
        Scene {
            truth: truth_set(truth),
            tracks: track_set(tracks),
            steps: StepSettings::default(),
        }
    }

    /// From lines `time id x y vx vy`.
    pub fn read(truth: &str, tracks: &str) -> Scene {
        Scene::new(&rows(truth), &rows(tracks))
    }

    pub fn compare(&self, gate_m: f64, reach_m: f64) -> Comparison {
        let settings = PointSettings {
            alignment: Alignment::Interpolate {
                max_gap_s: Some(5.0),
            },
            gate_m,
            reach_m: reach_m.max(gate_m),
            steps: self.steps,
            credit: Credit::Afterwards,
        };
        Comparison::of_points(&self.input(), &self.truth, &settings)
    }

    pub fn input(&self) -> EvaluationInput<'_> {
        EvaluationInput {
            recording: None,
            truth: Some(&self.truth),
            tracks: &self.tracks,
        }
    }

    pub fn evaluate(&self, gate_m: f64, spec: Value) -> MetricReport {
        evaluate_all(&[self], gate_m, spec)
    }
}

pub fn evaluate_all(scenes: &[&Scene], gate_m: f64, spec: Value) -> MetricReport {
    let metric = metric(spec);
    let reach_m = metric.reach_m(gate_m);
    let compared: Vec<_> = scenes
        .iter()
        .map(|scene| (scene.compare(gate_m, reach_m), scene))
        .collect();
    let logs: Vec<EventLog> = compared
        .iter()
        .map(|(comparison, _)| EventLog::new(comparison))
        .collect();
    let sequences: Vec<Sequence> = compared
        .iter()
        .zip(&logs)
        .map(|((comparison, scene), events)| Sequence {
            comparison,
            events,
            input: Some(scene.input()),
        })
        .collect();
    let report = metric.evaluate(&sequences);
    assert_sound(&report);
    report
}

/// The metric of a request, or the faults of it.
pub fn checked(spec: &Value) -> Result<Box<dyn Metric>, Vec<String>> {
    let mut faults = Vec::new();
    let spec = check_field(spec, &ANY, "", &mut faults);
    if !faults.is_empty() {
        return Err(faults
            .into_iter()
            .map(|fault| format!("{} {}", fault.pointer, fault.allowed.unwrap_or_default()))
            .collect());
    }
    let method = METRICS
        .iter()
        .find(|method| spec["metric"] == method.name)
        .unwrap();
    Ok((method.build)(&spec).unwrap())
}

pub fn metric(spec: Value) -> Box<dyn Metric> {
    checked(&spec).unwrap_or_else(|faults| panic!("{faults:?}"))
}

/// Every number is finite, and what is missing has a reason.
fn assert_sound(report: &MetricReport) {
    let lines = report
        .per_truth
        .iter()
        .chain(&report.per_track)
        .flat_map(|line| &line.quantities);
    for quantity in report.quantities.iter().chain(lines) {
        assert!(quantity.value.is_none_or(f64::is_finite), "{quantity:?}");
        assert_eq!(
            quantity.value.is_none(),
            quantity.reason.is_some(),
            "{quantity:?}"
        );
    }
    assert!(
        report
            .series
            .iter()
            .flat_map(|series| series.values.iter().flatten())
            .all(|value| value.is_finite())
    );
    assert!(!report.parameters.is_empty());
}

pub fn values(report: &MetricReport, series: &str) -> Vec<Option<f64>> {
    report
        .series
        .iter()
        .find(|found| found.name == series)
        .unwrap()
        .values
        .clone()
}

pub fn reason(report: &MetricReport, quantity: &str) -> &'static str {
    report
        .quantities
        .iter()
        .find(|found| found.name == quantity)
        .unwrap()
        .reason
        .unwrap()
}

pub fn close(left: f64, right: f64) -> bool {
    (left - right).abs() <= 1e-9 * right.abs().max(1.0)
}

pub fn assert_close(found: Option<f64>, expected: f64, what: &str) {
    assert!(
        found.is_some_and(|found| close(found, expected)),
        "{what}: found {found:?}, expected {expected}"
    );
}

pub fn assert_series(report: &MetricReport, name: &str, expected: &[f64]) {
    let found = values(report, name);
    assert_eq!(found.len(), expected.len(), "{name}");
    for (step, (found, expected)) in found.into_iter().zip(expected).enumerate() {
        assert_close(found, *expected, &format!("{name} at step {step}"));
    }
}

fn rows(text: &str) -> Vec<Row<'_>> {
    let row = |line| {
        let fields: Vec<&str> = str::split_whitespace(line).collect();
        let number = |place: usize| fields[place].parse::<f64>().unwrap();
        (
            number(0),
            fields[1],
            number(2),
            number(3),
            number(4),
            number(5),
        )
    };
    text.lines()
        .filter(|line| !line.trim().is_empty())
        .map(row)
        .collect()
}

fn truth_set(rows: &[Row]) -> TruthSet {
    let mut targets: Vec<Target> = Vec::new();
    for &(time_s, id, x, y, vx, vy) in rows {
        let point = TruthPoint::in_plane(time_s, Position::new(x, y), Some(Position::new(vx, vy)));
        match targets.iter_mut().find(|target| target.truth_id == id) {
            Some(target) => target.points.push(point),
            None => targets.push(Target {
                truth_id: id.to_owned(),
                points: vec![point],
            }),
        }
    }
    TruthSet::new(Space::Plane, targets).unwrap()
}

fn track_set(rows: &[Row]) -> TrackSet {
    let mut tracks: Vec<Track> = Vec::new();
    for &(time_s, id, x, y, vx, vy) in rows {
        let point = track_point(time_s, State::new(x, y, vx, vy), None);
        match tracks.iter_mut().find(|track| track.track_id == id) {
            Some(track) => track.points.push(point),
            None => tracks.push(Track {
                track_id: id.to_owned(),
                points: vec![point],
            }),
        }
    }
    TrackSet {
        tracks,
        ..TrackSet::default()
    }
}

pub fn track_point(time_s: f64, state: State, covariance: Option<Covariance>) -> TrackPoint {
    let estimate = Kinematics::of_plane(&state, true, covariance.as_ref());
    TrackPoint {
        height_m: None,
        time_s,
        sensor: None,
        estimate,
        status: None,
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    }
}

/// Gives a point of a track in the plane another covariance.
pub fn set_covariance(point: &mut TrackPoint, covariance: Covariance) {
    point.estimate.covariance = Some(upper_triangle(&covariance));
}
