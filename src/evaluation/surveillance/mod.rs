//! Requirements of air surveillance: updates, gaps, accuracy, identity, false and extra tracks, continuity, by sector and phase.
//!
//! # Method
//! 1. [`pairing`]: each update (a point of a track) finds its target.
//! 2. [`flights`]: each target's updates in the order of time, each with the truth at its time; the test whether a point lies in
//!    a sector is made once for all requirements of a phase.
//! 3. [`judge`]: each requirement counts what it is about, target by target; counts of targets are added, shares never averaged.
//!
//! The page on surveillance defines each requirement and says where other tools differ.

mod dubious;
mod events;
mod extra;
mod finding;
mod flights;
mod gaps;
mod judge;
mod marks;
mod numbers;
mod pairing;
mod reference;
mod score;
mod settings;
#[cfg(test)]
mod tests;
mod words;

pub use events::{Event, Fault};
pub use finding::{FailedTarget, Finding};
pub use pairing::PairedUpdates;
pub use settings::{Check, Pairing, Radar, Requirement, Sector, Settings};

use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use crate::model::watch::Watch;
use events::Log;
use finding::OfTargets;
use flights::{View, flights};
use judge::Scene;
use score::Score;
use words::Words;

/// Targets that fail by themselves and are named.
const MOST_NAMED: usize = 100;

/// What was found of all requirements.
#[derive(Debug)]
pub struct Assessment {
    /// Sector by sector, each in the order of the requirements; those of one phase stand together.
    pub findings: Vec<Finding>,
    pub updates: PairedUpdates,
    pub events: Vec<Event>,
    pub events_left_out: u64,
}

/// Judges tracks by requirements. What it says after the watch stopped it is not all.
pub fn assess(
    truth: &TruthSet,
    tracks: &TrackSet,
    settings: &Settings,
    watch: &Watch,
) -> Assessment {
    let words = Words { truth, tracks };
    let pairs = pairing::pair(words, settings, watch);
    let flights = flights(truth, tracks, &pairs, settings.reference_reach_s);
    let scene = Scene {
        words,
        pairs: &pairs,
        settings,
    };
    let mut findings = Vec::new();
    let mut log = Log::default();
    for sector in &settings.sectors {
        for (index, first) in settings.requirements.iter().enumerate() {
            let requirements = &settings.requirements;
            if requirements[..index]
                .iter()
                .any(|one| one.phase == first.phase)
            {
                continue;
            }
            let (place, reach_s) = ((sector, first.phase), settings.reference_reach_s);
            let views = flights
                .iter()
                .map(|flight| flight.view(truth, place, reach_s));
            let views: Vec<View> = views.collect();
            for requirement in requirements.iter().filter(|one| one.phase == first.phase) {
                if requirement.holds_in(sector) && !watch.stops_after(views.len() as u64) {
                    log.finding = findings.len();
                    findings.push(scene.find(sector, requirement, &views, &mut log));
                }
            }
        }
    }
    Assessment {
        findings,
        updates: pairs.updates,
        events: log.events,
        events_left_out: log.left_out,
    }
}

impl Requirement {
    fn holds_in(&self, sector: &Sector) -> bool {
        let names = self.sectors.as_ref();
        names.is_none_or(|names| names.contains(&sector.sector_id))
    }
}

impl Scene<'_> {
    /// Of requirements that go by tracks, not by targets.
    fn judge_sets(
        &self,
        check: &Check,
        sector: &Sector,
        views: &[View],
        log: &mut Log,
    ) -> Option<Score> {
        let sets = (self.words.tracks, self.pairs);
        Some(match check {
            Check::FalseUpdates {} => extra::judge_false_updates(sets, sector, log),
            Check::FalseTracks { per_km2 } => {
                let score = extra::judge_false_tracks(sets, sector, views, log);
                let areas = per_km2.and_then(|per_km2| Some(sector.area_km2()? / per_km2));
                Score { areas, ..score }
            }
            Check::DubiousTracks(doubts) => {
                dubious::judge_dubious_tracks((self.words, self.pairs), doubts, sector, log)
            }
            _ => return None,
        })
    }

    fn find(
        &self,
        sector: &Sector,
        requirement: &Requirement,
        views: &[View],
        log: &mut Log,
    ) -> Finding {
        let check = &requirement.check;
        let mut sum = Score::default();
        let mut failed = Vec::new();
        if let Some(of_sets) = self.judge_sets(check, sector, views, log) {
            sum = of_sets;
        } else {
            for view in views {
                let score = self.judge(requirement, view, log);
                let value = score.value(check);
                let held = value.and_then(|value| Some((value, requirement.bound.hold(value)?)));
                if let Some((value, (margin, false))) = held {
                    failed.push((margin, view.flight.target, value));
                }
                sum.add(&score);
            }
        }
        let mut targets = OfTargets::default();
        for view in views.iter().filter(|view| !view.periods.is_empty()) {
            targets.due += 1;
            targets.without_update += usize::from(view.judged().next().is_none());
        }
        failed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        targets.failed_count = failed.len();
        for (_, target, value) in failed.into_iter().take(MOST_NAMED) {
            let truth_id = self.words.truth.targets()[target].truth_id.clone();
            targets.failed.push(FailedTarget { truth_id, value });
        }
        requirement.finding(&sector.sector_id, sum, targets)
    }
}
