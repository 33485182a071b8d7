//! The points of truth and tracks, step by step.

use super::sweep::{Sweep, near_pairs};
use super::{Comparison, OwnTimes, PointSettings, Presence, presence};
use crate::evaluation::credit::Credit;
use crate::evaluation::extent::Extent;
use crate::evaluation::paths::{Paths, Reach};
use crate::evaluation::steps::Steps;
use crate::model::space::{Place, Space};
use crate::model::time::rounding_s;
use crate::model::track::{TrackPoint, TrackSet};
use std::collections::HashSet;

/// Who is at a step; tracks with how much later than the step they are.
#[derive(Default, Clone)]
struct Present {
    truths: Vec<Presence>,
    tracks: Vec<(Presence, f64)>,
}

/// A point of a track that belongs to no step.
struct Outside {
    time_s: f64,
    presence: Presence,
}

impl Comparison {
    pub(super) fn take_points(
        &mut self,
        tracks: &TrackSet,
        paths: &Paths,
        steps: &Steps,
        settings: &PointSettings,
        extent: &mut Extent,
    ) {
        let space = self.space.unwrap_or_default();
        let mut present = vec![Present::default(); steps.count()];
        if paths.space().has_places() == space.has_places() {
            add_truths(paths, steps, space, extent, &mut present);
        }
        let mut outside = Vec::new();
        if tracks.space.has_places() == space.has_places() {
            self.add_tracks(
                tracks,
                steps,
                (settings.credit, extent),
                (&mut present, &mut outside),
            );
        }
        self.warn_of_strangers(&present, paths, tracks, outside.is_empty());
        let reach = Reach::new(paths.clone(), self.gate);
        self.leave_early_and_late(steps, &mut present, &reach);
        let outside = self.leave_near(outside, paths, &reach, extent);
        let extra = extra_steps(outside, steps.tolerance_s);
        let sweep = Sweep {
            paths,
            space,
            gate_m: settings.gate_m,
            reach_m: settings.reach_m,
        };
        self.push_steps(steps, present, extra, &sweep, extent);
    }

    /// Each track's point nearest in time to a step; of two as near the later one.
    fn add_tracks(
        &mut self,
        set: &TrackSet,
        steps: &Steps,
        (credit, extent): (Credit, &mut Extent),
        (present, outside): (&mut [Present], &mut Vec<Outside>),
    ) {
        let space = self.space.unwrap_or_default();
        for (id, track) in set.tracks.iter().enumerate() {
            let mut guess = 0;
            for (index, point) in track.points.iter().enumerate() {
                if !credit.counts(point) {
                    self.facts.unknown_then += 1;
                    continue;
                }
                let presence = presence_of(space, (id, index), point);
                let Some(step) = steps.near(point.time_s, guess) else {
                    let time_s = point.time_s;
                    outside.push(Outside { time_s, presence });
                    continue;
                };
                guess = step + usize::from(point.time_s == steps.time_s(step));
                let after_s = point.time_s - steps.time_s(step);
                let list = &mut present[step].tracks;
                match list.last_mut().filter(|(last, _)| last.id == presence.id) {
                    None => list.push((presence, after_s)),
                    Some(last) => {
                        // Points at one time are of several sensors: the last one knows most.
                        self.facts.between_steps += usize::from(last.1 != after_s);
                        if after_s.abs() <= last.1.abs() + rounding_s(point.time_s) {
                            *last = (presence, after_s);
                        }
                    }
                }
            }
            if !extent.add_points(track.points.len()) {
                return;
            }
        }
    }

    /// Leaves out points of a step that are near a target at their own time which is not due at the step: it begins or ends in
    /// between, and nobody knows whether it was due.
    fn leave_early_and_late(&mut self, steps: &Steps, present: &mut [Present], reach: &Reach) {
        let space = self.space.unwrap_or_default();
        for (present, step_s) in present.iter_mut().zip(steps.times_s()) {
            let before = present.tracks.len();
            let truths = &present.truths;
            present.tracks.retain(|(point, after_s)| {
                let is_due = |target: usize| {
                    truths
                        .binary_search_by_key(&(target as u32), |truth| truth.id)
                        .is_ok()
                };
                let time_s = step_s + after_s;
                *after_s == 0.0 || !reach.is_near_only(space, time_s, &point.position_m, is_due)
            });
            self.facts.between_steps += before - present.tracks.len();
        }
    }

    /// The points that are near no target at their own time: nobody knows of the others whether they are due.
    fn leave_near(
        &mut self,
        outside: Vec<Outside>,
        paths: &Paths,
        reach: &Reach,
        extent: &mut Extent,
    ) -> Vec<Outside> {
        let stretches_s = paths.stretches_s();
        let space = self.space.unwrap_or_default();
        let mut kept = Vec::with_capacity(outside.len());
        for point in outside {
            let after = stretches_s.partition_point(|stretch| stretch.1 < point.time_s);
            let exists = stretches_s
                .get(after)
                .is_some_and(|stretch| stretch.0 <= point.time_s);
            let place = &point.presence.position_m;
            let looked_at = if exists { paths.targets().len() } else { 1 };
            if !extent.goes_on(looked_at) {
                break;
            }
            if exists && reach.is_near(space, point.time_s, place) {
                self.facts.between_steps += 1;
            } else {
                kept.push(point);
            }
        }
        kept
    }

    fn push_steps(
        &mut self,
        steps: &Steps,
        present: Vec<Present>,
        extra: Vec<(f64, Present)>,
        sweep: &Sweep,
        extent: &mut Extent,
    ) {
        let mut after_s = Vec::new();
        let mut extra = extra.into_iter().peekable();
        let due = steps.times_s().enumerate().zip(present);
        for ((step, time_s), present) in due {
            while let Some((extra_s, tracks)) = extra.next_if(|(extra_s, _)| *extra_s < time_s) {
                self.push_present((extra_s, true), tracks, None, sweep, extent, &mut after_s);
            }
            let window_s = Some(steps.window_s(step));
            if !self.push_present(
                (time_s, false),
                present,
                window_s,
                sweep,
                extent,
                &mut after_s,
            ) {
                return;
            }
        }
        for (extra_s, tracks) in extra {
            self.push_present((extra_s, true), tracks, None, sweep, extent, &mut after_s);
        }
        if after_s.iter().any(|&after_s| after_s != 0.0) {
            let paths = sweep.paths.clone().into_owned();
            self.own_times = Some(OwnTimes { after_s, paths });
        }
    }

    /// Whether to go on.
    fn push_present(
        &mut self,
        (time_s, is_extra): (f64, bool),
        present: Present,
        window_s: Option<(f64, f64)>,
        sweep: &Sweep,
        extent: &mut Extent,
        after_s: &mut Vec<f64>,
    ) -> bool {
        let first_pair = self.pairs.len();
        let first_track = after_s.len();
        let mut tracks = Vec::with_capacity(present.tracks.len());
        for (presence, later_s) in present.tracks {
            tracks.push(presence);
            after_s.push(later_s);
        }
        let own_s = &after_s[first_track..];
        let window_s = window_s.filter(|_| own_s.iter().any(|&later_s| later_s != 0.0));
        self.push_step(
            (time_s, is_extra),
            present.truths,
            tracks,
            |truths, tracks, found| match window_s {
                Some(window_s) => {
                    sweep.own_time_pairs(
                        (truths, tracks),
                        (time_s, own_s),
                        window_s,
                        extent,
                        found,
                    );
                }
                None => near_pairs((truths, tracks), sweep, extent, found),
            },
        );
        extent.end_step(self.pairs.len() - first_pair)
    }

    fn warn_of_strangers(
        &mut self,
        present: &[Present],
        paths: &Paths,
        set: &TrackSet,
        nobody_outside: bool,
    ) {
        for (name, space) in [("truth", paths.space()), ("tracks", set.space)] {
            if self.is_in_metres() && !space.has_places() {
                self.warnings.push(format!("the {name} are directions (bearing_deg) without places: nothing is compared in metres"));
                return;
            }
        }
        let targets = paths.targets().len();
        if targets > 0 && present.iter().all(|step| step.truths.is_empty()) {
            self.warnings.push("no target exists at any time of the comparison: the clocks of truth and tracks do not meet".into());
        }
        let is_absent = present.iter().all(|step| step.tracks.is_empty()) && nobody_outside;
        if !set.tracks.is_empty() && is_absent {
            self.warnings.push("no track exists at any time of the comparison: the clocks of tracks and recording do not meet".into());
        }
    }
}

fn presence_of(space: Space, place: (usize, usize), point: &TrackPoint) -> Presence {
    let (position, velocity): (&Place, _) = (&point.estimate.position, point.estimate.velocity);
    presence(space, place, position, velocity)
}

fn add_truths(
    paths: &Paths,
    steps: &Steps,
    space: Space,
    extent: &mut Extent,
    present: &mut [Present],
) {
    for id in 0..paths.targets().len() {
        let Some((from_s, to_s)) = paths.span_s(id, steps.tolerance_s) else {
            continue;
        };
        // One step more at both ends: sums of times are rounded, and the path decides.
        let from = steps.first_from(from_s).saturating_sub(1);
        let to = (steps.first_from(to_s) + 1).min(steps.count());
        let mut points = 0;
        for (step, now) in present.iter_mut().enumerate().take(to).skip(from) {
            if let Some((position, velocity)) = paths.at(id, steps.time_s(step), steps.tolerance_s)
            {
                now.truths
                    .push(presence(space, (id, 0), &position, velocity));
                points += 1;
            }
        }
        if !extent.add_points(points) {
            break;
        }
    }
}

/// Points that belong to no step, by their times; those of tracks within τ together.
fn extra_steps(mut outside: Vec<Outside>, tolerance_s: f64) -> Vec<(f64, Present)> {
    let order = |point: &Outside| (point.presence.id, point.presence.point);
    outside.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(order(a).cmp(&order(b))));
    let mut extra: Vec<(f64, Present)> = Vec::new();
    let mut seen = HashSet::new();
    for Outside { time_s, presence } in outside {
        let is_later = extra
            .last()
            .is_none_or(|(first_s, _)| time_s - first_s > tolerance_s + rounding_s(time_s));
        if is_later || seen.contains(&presence.id) {
            extra.push((time_s, Present::default()));
            seen.clear();
        }
        seen.insert(presence.id);
        if let Some((_, present)) = extra.last_mut() {
            present.tracks.push((presence, 0.0));
        }
    }
    for (_, present) in &mut extra {
        present.tracks.sort_by_key(|(presence, _)| presence.id);
    }
    extra
}
