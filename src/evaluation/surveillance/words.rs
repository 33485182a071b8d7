//! What updates and the truth say of who a target is, and whether they say the same.

use super::flights::{Flight, Update};
use super::reference::Reference;
use super::settings::{Code, Rule};
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;

/// Truth and tracks with their words.
#[derive(Clone, Copy)]
pub struct Words<'a> {
    pub truth: &'a TruthSet,
    pub tracks: &'a TrackSet,
}

/// A word without what two files may write otherwise: zeros in front, small letters.
pub fn normal(code: Code, word: &str) -> String {
    let word = word.trim().to_ascii_uppercase();
    match code {
        Code::Callsign => word,
        Code::Address | Code::ModeA | Code::ModeC => {
            let significant = word.trim_start_matches('0');
            if significant.is_empty() && !word.is_empty() {
                "0".to_owned()
            } else {
                significant.to_owned()
            }
        }
    }
}

impl<'a> Words<'a> {
    /// Of an update.
    pub fn of_update(&self, update: &Update, code: Code) -> Option<&'a str> {
        let track = &self.tracks.tracks[update.track as usize];
        self.of_track(&track.track_id, update.time_s, code)
    }

    pub fn of_track(&self, track_id: &str, time_s: f64, code: Code) -> Option<&'a str> {
        let of = (track_id, time_s);
        let tracks = self.tracks;
        tracks
            .changes
            .word(&tracks.attributes, of, code.attribute())
    }

    /// Of the truth before and after the time of a reference.
    pub fn of_truth(
        &self,
        target: usize,
        reference: &Reference,
        code: Code,
    ) -> [Option<&'a str>; 2] {
        let (truth, target) = (self.truth, &self.truth.targets()[target]);
        reference.beside.map(|point| {
            let of = (target.truth_id.as_str(), target.points[point].time_s);
            truth.changes.word(&truth.attributes, of, code.attribute())
        })
    }

    /// Whether an update says a code right: like the truth before or after it. `None` where the truth says none.
    fn agrees(
        &self,
        flight: &Flight,
        (update, reference): (&Update, &Reference),
        code: Code,
    ) -> Option<Agreement> {
        let known = self.of_truth(flight.target, reference, code);
        if known == [None, None] {
            return None;
        }
        let Some(word) = self.of_update(update, code) else {
            return Some(Agreement::Missing);
        };
        let word = normal(code, word);
        let is_right = known
            .iter()
            .flatten()
            .any(|known| normal(code, known) == word);
        Some(if is_right {
            Agreement::Same
        } else {
            Agreement::Other
        })
    }

    /// The worse stated accuracy (1 σ, m) of the points beside a reference; `None` where none is stated.
    pub fn accuracy_m(&self, target: usize, reference: &Reference) -> Option<f64> {
        let (truth, target) = (self.truth, &self.truth.targets()[target]);
        let mut worst_m = None;
        for point in reference.beside {
            let of = (target.truth_id.as_str(), target.points[point].time_s);
            let said = truth
                .changes
                .word(&truth.attributes, of, "position_accuracy_m");
            if let Some(accuracy_m) = said.and_then(finite) {
                worst_m = Some(f64::max(accuracy_m, worst_m.unwrap_or(accuracy_m)));
            }
        }
        worst_m
    }

    /// Each of the codes that the truth has.
    pub fn agreements(
        &self,
        flight: &Flight,
        judged: (&Update, &Reference),
        codes: &[Code],
    ) -> Vec<Agreement> {
        let of = |&code: &Code| self.agrees(flight, judged, code);
        codes.iter().filter_map(of).collect()
    }

    /// Differences to the Mode C height before and after (ft), the smaller in size; what is no number is no word.
    pub fn height_error_ft(
        &self,
        flight: &Flight,
        (update, reference): (&Update, &Reference),
    ) -> (bool, Option<f64>) {
        let known = self.of_truth(flight.target, reference, Code::ModeC);
        let known: Vec<f64> = known
            .iter()
            .flatten()
            .filter_map(|word| finite(word))
            .collect();
        let said = self.of_update(update, Code::ModeC).and_then(finite);
        let errors = said
            .into_iter()
            .flat_map(|said| known.iter().map(move |known| said - known));
        let error = errors.reduce(|one, other| if other.abs() < one.abs() { other } else { one });
        (!known.is_empty(), error)
    }
}

fn finite(word: &str) -> Option<f64> {
    let number: f64 = word.trim().parse().ok()?;
    number.is_finite().then_some(number)
}

/// What an update says of a code that the truth has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    Same,
    Other,
    Missing,
}

impl Rule {
    /// Whether any or all are of a kind.
    pub fn holds(self, agreements: &[Agreement], wanted: Agreement) -> bool {
        match self {
            Rule::Any => agreements.contains(&wanted),
            Rule::All => agreements.iter().all(|one| *one == wanted),
        }
    }
}
