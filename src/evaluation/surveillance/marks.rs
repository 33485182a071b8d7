//! What one update says of a requirement.

use super::flights::{Flight, Update};
use super::reference::{Reference, shorter_angle};
use super::settings::{Check, Code, Radar, Rule};
use super::words::{Agreement, Words};
use crate::model::space::Place;

/// How an update counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mark {
    Judged {
        /// Whether it is one of those that the value is the share of.
        is_hit: bool,
        is_fault: bool,
        error: Option<f64>,
        /// The quantity that has the error, as the update says it; of errors that may have a gain.
        measured: Option<f64>,
    },
    NotJudged(&'static str),
}

impl Mark {
    /// Of a share of what is right.
    fn right(is_right: bool, error: Option<f64>) -> Mark {
        Mark::Judged {
            is_hit: is_right,
            is_fault: !is_right,
            error,
            measured: None,
        }
    }

    /// Of a share of what is wrong.
    fn wrong(is_wrong: bool, error: Option<f64>) -> Mark {
        Mark::Judged {
            is_hit: is_wrong,
            is_fault: is_wrong,
            error,
            measured: None,
        }
    }
}

/// What an update with a reference says; `None` of requirements that do not go by updates.
pub fn mark(
    check: &Check,
    words: Words,
    flight: &Flight,
    judged: (&Update, &Reference),
) -> Option<Mark> {
    Some(match check {
        Check::PositionWithin { .. }
        | Check::PositionBeyond { .. }
        | Check::PositionRms {}
        | Check::PositionPercentile { .. } => mark_distance(check, judged),
        Check::Along { .. } | Check::Across { .. } | Check::Latency { .. } => {
            mark_component(check, judged)
        }
        Check::Speed { .. } | Check::Course { .. } => mark_motion(check, judged),
        Check::RadarRange { radar, max_m } if is_of(radar, words, judged.0) => {
            mark_range(radar, *max_m, judged)
        }
        Check::RadarAzimuth { radar, max_deg } if is_of(radar, words, judged.0) => {
            mark_azimuth(radar, *max_deg, judged)
        }
        Check::RadarRange { .. } | Check::RadarAzimuth { .. } => Mark::NotJudged("other_sensor"),
        Check::IdentityCorrect { of, rule } => {
            let agreements = words.agreements(flight, judged, of);
            if agreements.is_empty() {
                Mark::NotJudged("no_reference_identity")
            } else {
                Mark::right(rule.holds(&agreements, Agreement::Same), None)
            }
        }
        Check::IdentityFalse { of, rule } => mark_false(words, flight, judged, (of, *rule)),
        Check::ModeAFalse {} => mark_false(words, flight, judged, (&[Code::ModeA], Rule::Any)),
        Check::CodePresent { code } => {
            if words.of_truth(flight.target, judged.1, *code) == [None, None] {
                Mark::NotJudged("no_reference_code")
            } else {
                Mark::right(words.of_update(judged.0, *code).is_some(), None)
            }
        }
        Check::ModeCCorrect { max_difference_ft } => {
            let (is_known, error) = words.height_error_ft(flight, judged);
            if is_known {
                let is_right = error.is_some_and(|error| error.abs() <= *max_difference_ft);
                Mark::right(is_right, error)
            } else {
                Mark::NotJudged("no_reference_code")
            }
        }
        Check::ModeCFalse { max_difference_ft } => match words.height_error_ft(flight, judged) {
            (_, Some(error)) => Mark::wrong(error.abs() > *max_difference_ft, Some(error)),
            (false, None) => Mark::NotJudged("no_reference_code"),
            (true, None) => Mark::NotJudged("no_code"),
        },
        _ => return None,
    })
}

/// Whether the radar may have seen the update: where the tracks do not say who did, it may.
fn is_of(radar: &Radar, words: Words, update: &Update) -> bool {
    let Some((sensor, wanted)) = update.sensor.zip(radar.sensor_id.as_ref()) else {
        return true;
    };
    words.tracks.sensor_ids.get(sensor as usize) == Some(wanted)
}

/// The range of the update less that of the truth, along the ground.
fn mark_range(radar: &Radar, max_m: f64, (update, reference): (&Update, &Reference)) -> Mark {
    let range_m = |place: &Place| (place.xy() - radar.place_m()).norm();
    let measured_m = range_m(&update.place);
    let error_m = measured_m - range_m(&reference.place);
    Mark::Judged {
        is_hit: error_m.abs() <= max_m,
        is_fault: error_m.abs() > max_m,
        error: Some(error_m),
        measured: Some(measured_m),
    }
}

/// The bearing of the update less that of the truth, the shorter way; clockwise is positive.
fn mark_azimuth(radar: &Radar, max_deg: f64, (update, reference): (&Update, &Reference)) -> Mark {
    let bearing_rad = |place: &Place| {
        let away_m = place.xy() - radar.place_m();
        (away_m.norm() > 0.0).then(|| away_m.x.atan2(away_m.y))
    };
    let bearings = bearing_rad(&reference.place).zip(bearing_rad(&update.place));
    let Some((true_rad, seen_rad)) = bearings else {
        return Mark::NotJudged("at_the_radar");
    };
    let error_deg = shorter_angle(true_rad, seen_rad).to_degrees();
    Mark::Judged {
        is_hit: error_deg.abs() <= max_deg,
        is_fault: error_deg.abs() > max_deg,
        error: Some(error_deg),
        measured: Some(seen_rad.to_degrees().rem_euclid(360.0)),
    }
}

fn off(update: &Update, reference: &Reference) -> Place {
    update.place - reference.place
}

fn mark_distance(check: &Check, (update, reference): (&Update, &Reference)) -> Mark {
    let distance_m = off(update, reference).xy().norm();
    match *check {
        Check::PositionWithin { distance_m: most_m } => {
            Mark::right(distance_m <= most_m, Some(distance_m))
        }
        Check::PositionBeyond {
            distance_m: least_m,
            inclusive,
        } => {
            let is_beyond = distance_m > least_m || (inclusive && distance_m == least_m);
            Mark::wrong(is_beyond, Some(distance_m))
        }
        _ => Mark::Judged {
            is_hit: true,
            is_fault: false,
            error: Some(distance_m),
            measured: None,
        },
    }
}

/// Along the heading, ahead positive; across it, right positive; and how late the position is.
fn mark_component(check: &Check, (update, reference): (&Update, &Reference)) -> Mark {
    let Some(heading_rad) = reference.heading_rad else {
        return Mark::NotJudged("no_heading");
    };
    let (sin, cos) = heading_rad.sin_cos();
    let off = off(update, reference);
    let along_m = off.x * sin + off.y * cos;
    let across_m = off.x * cos - off.y * sin;
    match *check {
        Check::Along { max_m } => Mark::right(along_m.abs() <= max_m, Some(along_m)),
        Check::Across { max_m } => Mark::right(across_m.abs() <= max_m, Some(across_m)),
        Check::Latency { max_s } => match reference.speed_mps.filter(|speed| *speed > 0.0) {
            Some(speed_mps) => {
                let late_s = -along_m / speed_mps;
                Mark::right(late_s.abs() <= max_s, Some(late_s))
            }
            None => Mark::NotJudged("stands"),
        },
        _ => Mark::NotJudged("no_heading"),
    }
}

fn mark_motion(check: &Check, (update, reference): (&Update, &Reference)) -> Mark {
    let (Some(velocity), Some(true_mps)) = (update.velocity, reference.speed_mps) else {
        return Mark::NotJudged("no_velocity");
    };
    let speed_mps = velocity.xy().norm();
    match *check {
        Check::Speed {
            max_difference_mps,
            max_share,
        } => {
            let error = speed_mps - true_mps;
            let most_mps = max_difference_mps.max(max_share * speed_mps);
            Mark::right(error.abs() <= most_mps, Some(error))
        }
        Check::Course {
            max_difference_deg,
            min_speed_mps,
        } => {
            let heading_rad = reference.heading_rad.filter(|_| true_mps >= min_speed_mps);
            let (Some(heading_rad), true) = (heading_rad, speed_mps > 0.0) else {
                return Mark::NotJudged("slow");
            };
            let course_rad = velocity.x.atan2(velocity.y);
            let error = shorter_angle(heading_rad, course_rad).to_degrees();
            Mark::right(error.abs() <= max_difference_deg, Some(error))
        }
        _ => Mark::NotJudged("no_velocity"),
    }
}

/// Judged where truth and update both have one of the codes.
fn mark_false(
    words: Words,
    flight: &Flight,
    judged: (&Update, &Reference),
    (codes, rule): (&[Code], Rule),
) -> Mark {
    let agreements = words.agreements(flight, judged, codes);
    if agreements.is_empty() {
        Mark::NotJudged("no_reference_code")
    } else if agreements.iter().all(|one| *one == Agreement::Missing) {
        Mark::NotJudged("no_code")
    } else {
        Mark::wrong(rule.holds(&agreements, Agreement::Other), None)
    }
}

/// Whether an update counts where updates are expected; one whose reference has no such code does.
pub fn counts(check: &Check, words: Words, flight: &Flight, judged: (&Update, &Reference)) -> bool {
    match check {
        Check::IdentityUpdate { of, rule, .. } => {
            let agreements = words.agreements(flight, judged, of);
            agreements.is_empty() || rule.holds(&agreements, Agreement::Same)
        }
        Check::ModeCUpdate {
            max_difference_ft, ..
        } => {
            let (is_known, error) = words.height_error_ft(flight, judged);
            !is_known || error.is_some_and(|error| error.abs() <= *max_difference_ft)
        }
        _ => true,
    }
}
