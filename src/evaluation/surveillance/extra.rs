//! What nobody asked for: updates at times at which a target is not due, second numbers of one target, tracks of no target.

use super::events::{Fault, Log};
use super::flights::{Update, View, height_of};
use super::gaps::covers;
use super::numbers::lives;
use super::pairing::{Paired, Pairs};
use super::score::Score;
use super::settings::Sector;
use crate::model::track::TrackSet;
use std::collections::BTreeMap;

/// The fault of an update.
pub fn of_update(
    view: &View,
    update: &Update,
    what: &'static str,
    size: Option<(f64, &'static str)>,
) -> Fault {
    Fault {
        time_s: update.time_s,
        target: Some(view.flight.target),
        track: Some(update.track),
        what,
        size,
        place: Some(update.place),
    }
}

/// Updates in the sector at times that no period covers; few or short ones are nothing.
pub fn judge_extra_data(view: &View, (least, least_s): (u32, f64), log: &mut Log) -> Score {
    let mut score = Score::default();
    let mut extra = Vec::new();
    for (update, is_inside) in view.flight.updates.iter().zip(&view.is_seen_inside) {
        if !is_inside {
            score.leave_out("outside");
        } else if covers(&view.periods, update.time_s) {
            score.count(false, None);
        } else {
            extra.push(update);
        }
    }
    let lasts_s = match (extra.first(), extra.last()) {
        (Some(first), Some(last)) => last.time_s - first.time_s,
        _ => 0.0,
    };
    let is_ignored = extra.len() < least as usize || lasts_s < least_s;
    for update in extra {
        if is_ignored {
            score.leave_out("few_or_short");
        } else {
            score.count(true, None);
            log.add(of_update(view, update, "extra_data", None));
        }
    }
    score
}

/// Updates in the sector at whose time another number of the same target is alive.
pub fn judge_extra_track(
    view: &View,
    (least, least_s): (u32, f64),
    ends_after_s: f64,
    log: &mut Log,
) -> Score {
    let mut score = Score::default();
    let mut inside = Vec::new();
    for (update, is_inside) in view.flight.updates.iter().zip(&view.is_seen_inside) {
        if *is_inside {
            inside.push(update);
        } else {
            score.leave_out("outside");
        }
    }
    let lives = lives(inside.iter().copied(), ends_after_s);
    let mut sizes: BTreeMap<u32, (u32, f64)> = BTreeMap::new();
    for life in &lives {
        let size = sizes.entry(life.track).or_default();
        *size = (size.0 + life.updates, size.1 + life.to_s - life.from_s);
    }
    sizes.retain(|_, size| size.0 >= least && size.1 >= least_s);
    let long = || lives.iter().filter(|life| sizes.contains_key(&life.track));
    let (begins_s, ends_s) = (
        rising(long().map(|life| life.from_s)),
        rising(long().map(|life| life.to_s)),
    );
    for update in inside {
        if !sizes.contains_key(&update.track) {
            score.leave_out("few_or_short");
            continue;
        }
        // Its own life is one of those that are alive.
        let begun = begins_s.partition_point(|time_s| *time_s <= update.time_s);
        let is_extra = begun - ends_s.partition_point(|time_s| *time_s < update.time_s) > 1;
        score.count(is_extra, None);
        if is_extra {
            log.add(of_update(view, update, "extra_track", None));
        }
    }
    score
}

fn rising(times_s: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut times_s: Vec<f64> = times_s.collect();
    times_s.sort_unstable_by(f64::total_cmp);
    times_s
}

/// Updates in the sector that are of no target.
pub fn judge_false_updates(
    (tracks, pairs): (&TrackSet, &Pairs),
    sector: &Sector,
    log: &mut Log,
) -> Score {
    let mut score = Score::default();
    for (number, (track, pairs)) in tracks.tracks.iter().zip(&pairs.of).enumerate() {
        for (point, paired) in track.points.iter().zip(pairs) {
            let place = point.estimate.position;
            let is_inside = sector.holds(&place, height_of(tracks.space, point));
            if *paired == Paired::NoUpdate || !is_inside {
                continue;
            }
            let is_false = *paired == Paired::Nobody;
            score.count(is_false, None);
            if is_false {
                log.add(Fault {
                    time_s: point.time_s,
                    target: None,
                    track: Some(number as u32),
                    what: "false_update",
                    size: None,
                    place: Some(place),
                });
            }
        }
    }
    score
}

/// Tracks no update of which is of a target, of those that are seen in the sector, over the hours from the first time that a target
/// is due there to the last.
pub fn judge_false_tracks(
    (tracks, pairs): (&TrackSet, &Pairs),
    sector: &Sector,
    views: &[View],
    log: &mut Log,
) -> Score {
    let mut score = Score::default();
    for (number, (track, pairs)) in tracks.tracks.iter().zip(&pairs.of).enumerate() {
        let updates = track.points.iter().zip(pairs);
        let mut updates = updates.filter(|(_, paired)| **paired != Paired::NoUpdate);
        let first = updates.find(|(point, _)| {
            let height_m = height_of(tracks.space, point);
            sector.holds(&point.estimate.position, height_m)
        });
        let Some((first, _)) = first else {
            continue;
        };
        let mut pairs = pairs.iter();
        let is_false = !pairs.any(|paired| matches!(paired, Paired::Target(_)));
        score.count(is_false, None);
        if is_false {
            log.add(Fault {
                time_s: first.time_s,
                target: None,
                track: Some(number as u32),
                what: "false_track",
                size: None,
                place: Some(first.estimate.position),
            });
        }
    }
    let (mut from_s, mut to_s) = (f64::INFINITY, f64::NEG_INFINITY);
    for period in views.iter().flat_map(|view| &view.periods) {
        (from_s, to_s) = (from_s.min(period.0), to_s.max(period.1));
    }
    score.hours = (to_s - from_s).max(0.0) / 3600.0;
    score
}
