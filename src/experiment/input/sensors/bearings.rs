//! Sensors of bearings alone: where they have to be known, and which of them may start tracks of places.

use super::{detections_of, usable_reports};
use crate::experiment::request::methods::NamedFilter;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensing::RangePrior;
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;

/// At so many ranges a track starts where nobody says it.
const RANGES: u32 = 5;

/// A fault where a filter of places is given bearings alone, and none of them may start a track.
pub(super) fn nothing_starts(
    recording: &Recording,
    known: &[SensorSettings],
    named: &NamedFilter,
) -> Option<Fault> {
    let has_prior = known.iter().any(|settings| range_prior(settings).is_some());
    let is_flat = named.filter.space() == Space::Plane;
    let starts =
        is_flat && named.filter.uses_ranges() && (has_prior || may_cross(recording, known));
    if !named.filter.space().has_places() || any_locates(recording, known) || starts {
        return None;
    }
    let is_heard = |index: usize| detections_of(recording, index).next().is_some();
    let heard: Vec<String> = known
        .iter()
        .enumerate()
        .filter(|(index, _)| is_heard(*index))
        .map(|(_, settings)| format!("'{}'", settings.sensor_id))
        .collect();
    let who = match heard.as_slice() {
        [] => return None,
        [one] => format!("sensor {one} reports"),
        several => format!("sensors {} report", several.join(", ")),
    };
    let detail = format!(
        "{who} bearings without ranges, which the filter '{}' cannot use",
        named.name
    );
    Some(
        Fault::new("/filter/method", "unsupported", detail).allowing(usable_reports(&named.filter)),
    )
}

/// A fault where tracks should start at reports that do not say where their targets are.
pub(super) fn unable_start(
    settings: &SensorSettings,
    starts: bool,
    is_direction: bool,
) -> Option<Fault> {
    if starts || settings.may_start != Some(true) {
        return None;
    }
    let what = if is_direction {
        "bearings, of which one alone does not say where a target is"
    } else {
        "no heights, without which no track of a volume starts"
    };
    let detail = format!("sensor '{}' reports {what}", settings.sensor_id);
    Some(Fault::new("/sensors", "unsupported", detail).allowing("may_start false"))
}

/// Where targets may be along the bearings of a sensor, if that is told.
pub(super) fn range_prior(settings: &SensorSettings) -> Option<RangePrior> {
    let (min_m, max_m) = settings.range_min_m.zip(settings.range_max_m)?;
    Some(RangePrior {
        min_m,
        max_m,
        ranges: settings.range_filters.unwrap_or(RANGES),
    })
}

/// A fault where tracks start at ranges of which the filter can keep but one.
pub(super) fn unfit_filter(settings: &SensorSettings, named: &NamedFilter) -> Option<Fault> {
    range_prior(settings).filter(|_| settings.may_start != Some(false))?;
    if !named.filter.space().has_places() || named.filter.at_ranges().is_some() {
        return None;
    }
    let detail = format!(
        "sensor '{}' starts tracks at several ranges, which the filter '{}' cannot do: its targets are in space or have more than a position and a velocity",
        settings.sensor_id, named.name
    );
    Some(
        Fault::new("/filter/method", "unsupported", detail).allowing(
            "extended, unscented; constant_velocity, coordinated_turn, ornstein_uhlenbeck",
        ),
    )
}

/// A fault where the limits of ranges are not two, or in the wrong order.
pub(super) fn unfit_prior(settings: &SensorSettings) -> Option<Fault> {
    let id = &settings.sensor_id;
    let (code, detail) = match (settings.range_min_m, settings.range_max_m) {
        (None, None) => return None,
        (Some(min_m), Some(max_m)) if min_m < max_m => return None,
        (Some(min_m), Some(max_m)) => (
            "out_of_range",
            format!(
                "sensor '{id}': a range_min_m of {min_m} m is not below range_max_m, {max_m} m"
            ),
        ),
        _ => (
            "missing",
            format!("sensor '{id}': range_min_m and range_max_m come together"),
        ),
    };
    Some(Fault::new("/sensors", code, detail).allowing("range_min_m < range_max_m"))
}

/// Whether bearings of two sensors may cross: both may start tracks, and they are not known to stand at one place.
pub(super) fn may_cross(recording: &Recording, known: &[SensorSettings]) -> bool {
    let starting: Vec<usize> = (0..known.len())
        .filter(|&index| {
            known[index].may_start == Some(true) && reports_bearings(recording, index, known)
        })
        .collect();
    let place = |index: usize| known[index].x_m.zip(known[index].y_m);
    starting.iter().enumerate().any(|(count, &first)| {
        let others = &starting[count + 1..];
        others.iter().any(|&other| {
            moves(recording, first) || moves(recording, other) || place(first) != place(other)
        })
    })
}

fn reports_bearings(recording: &Recording, index: usize, known: &[SensorSettings]) -> bool {
    let mut seen = detections_of(recording, index).peekable();
    if seen.peek().is_none() {
        return tells_bearings(&known[index]);
    }
    seen.all(|detection| detection.measurement.is_direction())
}

/// Whether all scans of a sensor say where it is.
pub(super) fn moves(recording: &Recording, index: usize) -> bool {
    let mut scans = recording
        .scans
        .iter()
        .filter(|scan| scan.sensor == index)
        .peekable();
    scans.peek().is_some() && scans.all(|scan| scan.pose.is_some())
}

/// Whether some report says where its target is, or a sensor that never reported anything would.
pub(super) fn any_locates(recording: &Recording, known: &[SensorSettings]) -> bool {
    let mut reports = recording.detections();
    let mut silent = known
        .iter()
        .enumerate()
        .filter(|(index, _)| detections_of(recording, *index).next().is_none());
    reports.any(|detection| !detection.measurement.is_direction())
        || silent.any(|(_, settings)| tells_places(settings))
}

/// Whether the settings are those of a sensor that reports places.
fn tells_places(settings: &SensorSettings) -> bool {
    settings.sigma_x_m.is_some() || settings.sigma_range_m.is_some()
}

/// Whether they are those of a sensor that reports bearings alone.
pub(super) fn tells_bearings(settings: &SensorSettings) -> bool {
    settings.sigma_bearing_deg.is_some() && !tells_places(settings)
}

/// Bearings place a target of the plane only from a place that is known.
pub(super) fn unknown_place(
    recording: &Recording,
    index: usize,
    settings: &SensorSettings,
) -> Option<Fault> {
    if (settings.x_m.is_some() && settings.y_m.is_some()) || moves(recording, index) {
        return None;
    }
    let detail = format!(
        "sensor '{}' reports bearings, and where it stands is not known: give 'x_m' and 'y_m' in 'sensors'",
        settings.sensor_id
    );
    Some(Fault::new("/sensors", "missing", detail).allowing("a place (m)"))
}
