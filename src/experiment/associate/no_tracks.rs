//! Why a job with detections has no track: a warning that names the settings that decide it, and values that would do.

use super::apparent_speed::apparent_speed;
use super::speeds::{SIGMA_OF_FASTEST, two_digits};
use super::track::{ResolvedRecording, Tracked};
use crate::filtering::AnyFilter;
use crate::tracking::{Confirmation, Initiation, Lifecycle, SPEED_REACH};

/// A warning where there are detections and no track was ever confirmed; none where tracks begin at the truth.
pub fn warning(
    tracked: &Tracked,
    data: &ResolvedRecording,
    lifecycle: &Lifecycle,
    filter: &AnyFilter,
) -> Option<String> {
    let recording = data.recording;
    let begins_at_truth = matches!(lifecycle.initiation, Initiation::Truth { .. });
    if recording.detection_count() == 0 || begins_at_truth || !tracked.tracks.tracks.is_empty() {
        return None;
    }
    let started: u64 = tracked
        .scans
        .iter()
        .map(|scan| u64::from(scan.started))
        .sum();
    let advice = if !filter.space().has_places() {
        "; a larger initial_rate_sigma_degps of the filter, a larger gate_probability or fewer confirm_hits confirm more".to_owned()
    } else {
        advice(data, lifecycle)
    };
    Some(format!(
        "no track was confirmed: {started} began with {} detections in {} scans (gate_probability {}{}, {}){advice}",
        recording.detection_count(),
        recording.scans.len(),
        lifecycle.gate_probability,
        speed_text(lifecycle, filter),
        confirmation_text(lifecycle)
    ))
}

fn speed_text(lifecycle: &Lifecycle, filter: &AnyFilter) -> String {
    match (lifecycle.initiation, filter) {
        (_, AnyFilter::Bearing(filter)) => format!(
            ", initial_rate_sigma_degps {}",
            filter.initial_rate_sigma_radps.to_degrees()
        ),
        (Initiation::TwoPoint { max_speed_mps, .. }, _) => {
            format!(", max_speed_mps {max_speed_mps}")
        }
        _ => format!(
            ", initial_speed_sigma_mps {}",
            lifecycle.initial_speed_sigma_mps
        ),
    }
}

fn confirmation_text(lifecycle: &Lifecycle) -> String {
    match lifecycle.confirmation {
        Confirmation::MOfN => format!(
            "confirmed by {} detections of {} scans",
            lifecycle.confirm_hits, lifecycle.confirm_window
        ),
        Confirmation::Score(rule) => format!(
            "confirmed by score, false_track_probability {}",
            rule.false_track_probability
        ),
        Confirmation::Existence(rule) => format!(
            "confirmed by a probability of existence of {}",
            rule.confirm_existence
        ),
    }
}

/// Values that would do, by the first of the settings that is at odds with the data.
fn advice(data: &ResolvedRecording, lifecycle: &Lifecycle) -> String {
    let scans = data
        .recording
        .scans
        .iter()
        .filter(|scan| !scan.detections.is_empty())
        .count();
    if lifecycle.confirmation == Confirmation::MOfN && scans < lifecycle.confirm_hits as usize {
        return format!(
            "; only {scans} scans have detections: confirm_hits {} or less could confirm one",
            scans.max(1)
        );
    }
    let apparent = apparent_speed(data.recording, data.known, data.sensors);
    let fastest_mps = apparent.and_then(|apparent| apparent.fastest_mps);
    let is_within = |fastest_mps: f64| match lifecycle.initiation {
        Initiation::TwoPoint { max_speed_mps, .. } => fastest_mps <= max_speed_mps,
        _ => fastest_mps <= SPEED_REACH * lifecycle.initial_speed_sigma_mps,
    };
    match fastest_mps {
        Some(fastest_mps) if !is_within(fastest_mps) => {
            let (name, value) = match lifecycle.initiation {
                Initiation::TwoPoint { .. } => ("max_speed_mps", SPEED_REACH * SIGMA_OF_FASTEST * fastest_mps),
                _ => ("initial_speed_sigma_mps", SIGMA_OF_FASTEST * fastest_mps),
            };
            format!(
                "; detections of three scans in a row follow each other at {} m/s: {name} {} or more lets them in",
                two_digits(fastest_mps),
                two_digits(value)
            )
        }
        Some(_) => {
            "; detections do follow each other at such speeds: fewer confirm_hits, a larger gate_probability or larger noises of the \
                    sensors confirm more"
                .to_owned()
        }
        None => "; hardly any three detections of successive scans lie on one course: are the noises of the sensors and the units right?"
            .to_owned(),
    }
}
