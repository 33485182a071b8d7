//! What of a request to correlate no table can see.

use crate::experiment::plan::{Estimate, fill_tracking_defaults, refuse};
use crate::model::fault::Fault;
use crate::simulation::LocalTracks;
use serde::Deserialize;
use serde_json::Value;

/// Estimates of all tracks at all common times that one job holds.
pub(super) const MAX_ESTIMATES: usize = 1_000_000;

/// Exactly one of `sets` and `input`, with the settings that go with it.
pub fn check(spec: &mut Value, faults: &mut Vec<Fault>) {
    match (
        spec.get("sets").is_some(),
        spec.pointer("/input/source").and_then(Value::as_str),
    ) {
        (true, Some(_)) => faults.push(Fault::new(
            "/input",
            "conflict",
            "give either 'sets' or 'input', not both",
        )),
        (true, None) => refuse(
            spec,
            &["associator", "filter", "tracker"],
            "needs 'input'; 'sets' are tracks already",
            faults,
        ),
        (false, Some("local_tracks")) => {
            refuse(
                spec,
                &["associator", "filter", "tracker", "sensors", "truth"],
                "does not go with drawn tracks",
                faults,
            );
        }
        (false, Some(_)) => fill_tracking_defaults(spec),
        (false, None) => {
            faults.push(
                Fault::new(
                    "",
                    "missing",
                    "give 'sets' of tracks, or 'input' to track first",
                )
                .allowing("sets, input"),
            );
        }
    }
    if spec["sets"].as_array().is_some_and(|sets| sets.len() == 1) {
        faults.push(one_sensor("/sets", 1));
    }
    if spec
        .pointer("/input/tracks/sensors")
        .and_then(Value::as_u64)
        == Some(1)
    {
        faults.push(one_sensor("/input/tracks/sensors", 1));
    }
    check_alignment(spec, faults);
    check_confirmation(spec, faults);
}

/// Tracks of one sensor have nothing to be put together with.
pub(super) fn one_sensor(pointer: &str, count: usize) -> Fault {
    let detail =
        format!("there are tracks of {count} sensor, and nothing to put them together with");
    Fault::new(pointer, "unsupported", detail).allowing("two sensors or more")
}

fn check_alignment(spec: &Value, faults: &mut Vec<Fault>) {
    let alignment = &spec["alignment"];
    if alignment.get("reference").is_some() && alignment.get("period_s").is_some() {
        let detail = "common times are either those of a sensor or equally far apart";
        faults.push(
            Fault::new("/alignment/period_s", "conflict", detail)
                .allowing("reference or period_s, not both"),
        );
    }
    if alignment.get("sigma_mps").is_some() && alignment.get("sigma_m").is_none() {
        let detail = "'sigma_mps' is assumed where tracks carry no covariance, beside 'sigma_m'";
        faults.push(Fault::new("/alignment/sigma_m", "missing", detail).allowing("> 0 m"));
    }
}

fn check_confirmation(spec: &Value, faults: &mut Vec<Fault>) {
    let number = |name: &str| spec["confirm"][name].as_u64().unwrap_or(1);
    let (found, of) = (number("found"), number("of"));
    if found > of {
        let detail = format!("a tuple cannot be found {found} times in {of} decisions");
        faults.push(
            Fault::new("/confirm/found", "out_of_range", detail)
                .allowing(format!("[1, {of}] (of)")),
        );
    }
    let times = spec.pointer("/input/tracks/times").and_then(Value::as_u64);
    if let Some(times) = times.filter(|&times| of > times) {
        faults.push(too_few_times(of as usize, times as usize));
    }
}

pub(super) fn too_few_times(of: usize, times: usize) -> Fault {
    let detail = format!("{of} decisions need as many common times, and there are {times}");
    Fault::new("/confirm/of", "out_of_range", detail).allowing(format!("[1, {times}]"))
}

/// What drawn tracks will cost; too many are refused.
pub fn estimate(spec: &Value, faults: &mut Vec<Fault>) -> Option<Estimate> {
    let plan = LocalTracks::deserialize(spec.pointer("/input/tracks")?).ok()?;
    let points = plan.points();
    // Reckoned with 2 µs and 700 bytes a point, from drawing to the written files.
    let estimate = Estimate {
        detections: points as u64,
        cost_s: points * 2e-6,
        bytes: (points * 700.0) as u64,
    };
    if points > MAX_ESTIMATES as f64 {
        faults.push(too_many_estimates("/input/tracks", points, estimate.cost_s));
    }
    Some(estimate)
}

pub(super) fn too_many_estimates(pointer: &str, points: f64, cost_s: f64) -> Fault {
    let detail = format!(
        "the tracks say something {points:.0} times, about {cost_s:.0} s of work before the first is compared"
    );
    Fault::new(pointer, "too_large", detail)
        .allowing(format!("at most {MAX_ESTIMATES} tracks × common times"))
}
