//! Tracks that nobody would believe, told without any truth.

use super::events::{Fault, Log};
use super::flights::height_of;
use super::pairing::{Paired, Pairs};
use super::reference::shorter_angle;
use super::score::Score;
use super::settings::{Code, Doubts, Sector};
use super::words::Words;
use crate::model::track::{Track, TrackPoint};

/// Rates are taken between updates that are so far apart (s).
const APART_S: std::ops::RangeInclusive<f64> = 1.0..=30.0;

/// Tracks too many updates of which are dubious, of those that are seen in the sector.
pub fn judge_dubious_tracks(
    (words, pairs): (Words, &Pairs),
    doubts: &Doubts,
    sector: &Sector,
    log: &mut Log,
) -> Score {
    let mut score = Score::default();
    for (number, (track, pairs)) in words.tracks.tracks.iter().zip(&pairs.of).enumerate() {
        let updates = track.points.iter().zip(pairs);
        let updates: Vec<&TrackPoint> = updates
            .filter(|(_, paired)| **paired != Paired::NoUpdate)
            .map(|(point, _)| point)
            .collect();
        let Some((first, share)) = dubious_share(words, doubts, sector, (track, &updates)) else {
            continue;
        };
        let is_dubious = share > doubts.max_share;
        score.count(is_dubious, None);
        if is_dubious {
            log.add(Fault {
                time_s: first.time_s,
                target: None,
                track: Some(number as u32),
                what: "dubious_track",
                size: Some((share, "")),
                place: Some(first.estimate.position),
            });
        }
    }
    score
}

/// The first update in the sector, and the share of those there that are dubious.
fn dubious_share<'u>(
    words: Words,
    doubts: &Doubts,
    sector: &Sector,
    (track, updates): (&Track, &[&'u TrackPoint]),
) -> Option<(&'u TrackPoint, f64)> {
    let space = words.tracks.space;
    let is_inside =
        |point: &&&TrackPoint| sector.holds(&point.estimate.position, height_of(space, point));
    let inside: Vec<&TrackPoint> = updates.iter().filter(is_inside).copied().collect();
    let (first, last) = (*inside.first()?, *inside.last()?);
    let is_short = inside.len() < doubts.min_updates as usize
        || last.time_s - first.time_s < doubts.min_duration_s;
    // What left the sector may be short there.
    let is_short = is_short && inside.len() == updates.len();
    let mut dubious = 0;
    let mut before = None;
    for point in &inside {
        let is_unnamed = doubts.needs_code && is_unnamed(words, track, point);
        let is_wild = moves_wildly(words, doubts, before, point);
        dubious += usize::from(is_short || is_unnamed || is_wild);
        before = Some(*point);
    }
    Some((first, dubious as f64 / inside.len() as f64))
}

fn is_unnamed(words: Words, track: &Track, point: &TrackPoint) -> bool {
    let codes = [Code::Address, Code::Callsign, Code::ModeA];
    let said = |code| {
        words
            .of_track(&track.track_id, point.time_s, code)
            .is_some()
    };
    !codes.into_iter().any(said)
}

/// Faster, or since the update before turning, accelerating or climbing more than anything does.
fn moves_wildly(
    words: Words,
    doubts: &Doubts,
    before: Option<&TrackPoint>,
    point: &TrackPoint,
) -> bool {
    let motion = |point: &TrackPoint| {
        let velocity = point.estimate.velocity?.xy();
        Some((velocity.norm(), velocity.x.atan2(velocity.y)))
    };
    let now = motion(point);
    if now.is_some_and(|(speed_mps, _)| speed_mps > doubts.max_speed_mps) {
        return true;
    }
    let Some(before) = before else {
        return false;
    };
    let after_s = point.time_s - before.time_s;
    if !APART_S.contains(&after_s) {
        return false;
    }
    let space = words.tracks.space;
    let heights_m = height_of(space, before).zip(height_of(space, point));
    let climbs = heights_m
        .is_some_and(|(from_m, to_m)| (to_m - from_m).abs() > doubts.max_climb_mps * after_s);
    let turns = motion(before).zip(now).is_some_and(|(from, to)| {
        let turned_deg = shorter_angle(from.1, to.1).abs().to_degrees();
        (to.0 - from.0).abs() > doubts.max_acceleration_mps2 * after_s
            || turned_deg > doubts.max_turn_degps * after_s
    });
    climbs || turns
}
