//! One requirement of one target in one sector.

use super::events::{Fault, Log};
use super::extra::{judge_extra_data, judge_extra_track, of_update};
use super::flights::View;
use super::gaps::GapRule;
use super::marks::{Mark, counts, mark};
use super::numbers::{handovers, is_swap, lives, longest};
use super::pairing::Pairs;
use super::reference::{Reference, reference_at};
use super::score::Score;
use super::settings::{Check, Requirement, Settings};
use super::words::Words;
use crate::model::space::Place;

/// What all judgements look at.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    pub words: Words<'a>,
    pub pairs: &'a Pairs,
    pub settings: &'a Settings,
}

impl Scene<'_> {
    /// Counts what a flight says of a check; its faults go into the log.
    pub fn judge(&self, requirement: &Requirement, view: &View, log: &mut Log) -> Score {
        let check = &requirement.check;
        if let Some(rule) = check.gap_rule() {
            return self.judge_gaps(check, &rule, view, log);
        }
        match *check {
            Check::ExtraData {
                min_updates,
                min_duration_s,
            } => judge_extra_data(view, (min_updates, min_duration_s), log),
            Check::ExtraTrack {
                min_updates,
                min_duration_s,
                ends_after_s,
            } => judge_extra_track(view, (min_updates, min_duration_s), ends_after_s, log),
            Check::Continuity { ends_after_s } => self.judge_continuity(view, ends_after_s, log),
            Check::InitiationDelay { max_delay_s } => judge_delay(view, max_delay_s, log),
            Check::LongestTrack {} => {
                let (numerator, denominator) = longest(view);
                Score {
                    numerator,
                    denominator,
                    ..Score::default()
                }
            }
            _ => self.judge_updates(requirement, view, log),
        }
    }

    fn judge_gaps(&self, check: &Check, rule: &GapRule, view: &View, log: &mut Log) -> Score {
        let flight = view.flight;
        let mut updates = Vec::with_capacity(flight.updates.len());
        for (update, is_inside) in flight.updates.iter().zip(&view.inside) {
            let reference = update.reference.as_ref().filter(|_| *is_inside);
            let counted =
                reference.map(|reference| counts(check, self.words, flight, (update, reference)));
            updates.push((update.time_s, counted));
        }
        let expected = rule.expected(&view.periods);
        let missed = rule.missed(&view.periods, &updates);
        let misses: u64 = missed.iter().map(|(_, misses)| misses).sum();
        for ((from_s, to_s), _) in missed {
            log.add(Fault {
                time_s: from_s,
                target: Some(flight.target),
                track: None,
                what: "gap",
                size: Some((to_s - from_s, "s")),
                place: self.true_place(flight.target, from_s),
            });
        }
        let misses = misses.min(expected);
        let is_of_gaps = matches!(check, Check::LongGaps { .. });
        Score {
            numerator: if is_of_gaps {
                misses
            } else {
                expected - misses
            },
            denominator: expected,
            ..Score::default()
        }
    }

    fn true_place(&self, target: usize, time_s: f64) -> Option<Place> {
        let reach_s = self.settings.reference_reach_s;
        let reference = reference_at(self.words.truth, target, time_s, reach_s)?;
        Some(reference.place)
    }

    fn judge_updates(&self, requirement: &Requirement, view: &View, log: &mut Log) -> Score {
        let (check, flight) = (&requirement.check, view.flight);
        let mut score = Score::default();
        for (update, is_inside) in flight.updates.iter().zip(&view.inside) {
            let Some(reference) = &update.reference else {
                score.leave_out("no_reference");
                continue;
            };
            if !is_inside {
                score.leave_out("outside");
                continue;
            }
            if self.is_inaccurate(requirement, flight.target, reference) {
                score.leave_out("reference_inaccurate");
                continue;
            }
            match mark(check, self.words, flight, (update, reference)) {
                Some(Mark::Judged {
                    is_hit,
                    is_fault,
                    error,
                    measured,
                }) => {
                    score.count(is_hit, error);
                    score.measured.extend(measured);
                    if is_fault {
                        let size = error.zip(check.error_unit());
                        log.add(of_update(view, update, check.name(), size));
                    }
                }
                Some(Mark::NotJudged(reason)) => score.leave_out(reason),
                None => {}
            }
        }
        score
    }

    /// Whether the truth says itself that it is not accurate enough. Where it says nothing it is.
    fn is_inaccurate(&self, requirement: &Requirement, target: usize, at: &Reference) -> bool {
        let worst_m = requirement.reference_accuracy_m;
        let stated_m = worst_m.and_then(|_| self.words.accuracy_m(target, at));
        stated_m
            .zip(worst_m)
            .is_some_and(|(stated_m, worst_m)| stated_m > worst_m)
    }

    /// Changes of the number that carries a target.
    fn judge_continuity(&self, view: &View, ends_after_s: f64, log: &mut Log) -> Score {
        let target = view.flight.target;
        let updates = view.judged().map(|(update, _)| update);
        let handovers = handovers(&lives(updates, ends_after_s));
        for handover in &handovers {
            let is_swap = is_swap(handover, target, self.pairs);
            log.add(Fault {
                time_s: handover.time_s,
                target: Some(target),
                track: Some(handover.to),
                what: if is_swap { "swap" } else { "new_number" },
                size: None,
                place: self.true_place(target, handover.time_s),
            });
        }
        Score {
            numerator: handovers.len() as u64,
            hours: view.hours(),
            ..Score::default()
        }
    }
}

/// From the first time that a target is due to its first update from then on.
fn judge_delay(view: &View, most_s: f64, log: &mut Log) -> Score {
    let mut score = Score::default();
    let Some(&(from_s, _)) = view.periods.first() else {
        return score;
    };
    let first = view.judged().find(|(update, _)| update.time_s >= from_s);
    let delay_s = first.map(|(update, _)| update.time_s - from_s);
    let is_right = delay_s.is_some_and(|delay_s| delay_s <= most_s);
    score.count(is_right, delay_s);
    if !is_right {
        let what = if delay_s.is_some() {
            "late"
        } else {
            "never_seen"
        };
        log.add(Fault {
            time_s: from_s,
            target: Some(view.flight.target),
            track: first.map(|(update, _)| update.track),
            what,
            size: delay_s.map(|delay_s| (delay_s, "s")),
            place: first.map(|(update, _)| update.place),
        });
    }
    score
}
