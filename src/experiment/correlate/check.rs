//! What of a request to correlate no table can see.

use crate::experiment::associate::check::fill_tracking_defaults;
use crate::experiment::job::Cost;
use crate::experiment::request::draft::Draft;
use crate::model::fault::Fault;
use crate::simulation::LocalTracks;

/// Estimates of all tracks at all common times that one job holds.
pub const MAX_ESTIMATES: usize = 1_000_000;

/// Exactly one of `sets` and `input`, with the settings that go with it.
pub fn check_tracks(draft: &mut Draft) {
    match (draft.has("sets"), draft.text_at("/input/source")) {
        (true, Some(_)) => {
            let detail = "give either 'sets' or 'input', not both";
            draft.add([Fault::new("/input", "conflict", detail)]);
        }
        (true, None) => {
            let why = "needs 'input'; 'sets' are tracks already";
            draft.refuse(&["associator", "filter", "tracker"], why);
        }
        (false, Some("local_tracks")) => {
            let names = ["associator", "filter", "tracker", "sensors", "truth"];
            draft.refuse(&names, "does not go with drawn tracks");
        }
        (false, Some(_)) => fill_tracking_defaults(draft),
        (false, None) => {
            let detail = "give 'sets' of tracks, or 'input' to track first";
            draft.add([Fault::new("", "missing", detail).allowing("sets, input")]);
        }
    }
    if draft.length_of("sets") == Some(1) {
        draft.add([one_sensor("/sets", 1)]);
    }
    if draft.count_at("/input/tracks/sensors") == Some(1) {
        draft.add([one_sensor("/input/tracks/sensors", 1)]);
    }
    check_alignment(draft);
    check_confirmation(draft);
}

/// Tracks of one sensor have nothing to be put together with.
pub fn one_sensor(pointer: &str, count: usize) -> Fault {
    let detail =
        format!("there are tracks of {count} sensor, and nothing to put them together with");
    Fault::new(pointer, "unsupported", detail).allowing("two sensors or more")
}

fn check_alignment(draft: &mut Draft) {
    let has = |name: &str| draft.at(&format!("/alignment/{name}")).is_some();
    let has_two_times = has("reference") && has("period_s");
    let has_speed_alone = has("sigma_mps") && !has("sigma_m");
    if has_two_times {
        let detail = "common times are either those of a sensor or equally far apart";
        draft.add([Fault::new("/alignment/period_s", "conflict", detail)
            .allowing("reference or period_s, not both")]);
    }
    if has_speed_alone {
        let detail = "'sigma_mps' is assumed where tracks carry no covariance, beside 'sigma_m'";
        draft.add([Fault::new("/alignment/sigma_m", "missing", detail).allowing("> 0 m")]);
    }
}

fn check_confirmation(draft: &mut Draft) {
    let found = draft.count_at("/confirm/found").unwrap_or(1);
    let of = draft.count_at("/confirm/of").unwrap_or(1);
    if found > of {
        let detail = format!("a tuple cannot be found {found} times in {of} decisions");
        draft.add([Fault::new("/confirm/found", "out_of_range", detail)
            .allowing(format!("[1, {of}] (of)"))]);
    }
    let times = draft.count_at("/input/tracks/times");
    if let Some(times) = times.filter(|&times| of > times) {
        draft.add([too_few_times(of as usize, times as usize)]);
    }
}

pub fn too_few_times(of: usize, times: usize) -> Fault {
    let detail = format!("{of} decisions need as many common times, and there are {times}");
    Fault::new("/confirm/of", "out_of_range", detail).allowing(format!("[1, {times}]"))
}

/// What drawn tracks will cost; too many are refused.
pub fn check_drawn_tracks(draft: &mut Draft) -> Option<Cost> {
    let points = draft.read::<LocalTracks>("/input/tracks")?.points();
    // Reckoned with 2 µs and 700 bytes a point, from drawing to the written files.
    let cost = Cost {
        detections: points as u64,
        cost_s: points * 2e-6,
        bytes: (points * 700.0) as u64,
    };
    if points > MAX_ESTIMATES as f64 {
        draft.add([too_many_estimates("/input/tracks", points, cost.cost_s)]);
    }
    Some(cost)
}

pub fn too_many_estimates(pointer: &str, points: f64, cost_s: f64) -> Fault {
    let detail = format!(
        "the tracks say something {points:.0} times, about {cost_s:.0} s of work before the first is compared"
    );
    Fault::new(pointer, "too_large", detail)
        .allowing(format!("at most {MAX_ESTIMATES} tracks × common times"))
}
