//! The strict verdict on each target, with the record of its first error.
//!
//! A truth string is *missed* when the automaton never left the start state, *correct* when it is accepted, else
//! *false*. A target is correct if all its strings are, missed if all are (or if it has none), else false. Its errors
//! are the scans at which its strings and the tracks that speak for them differ; a missed string counts its own real
//! symbols.

use super::automaton::{Automaton, Run};
use super::build::Beginnings;
use crate::evaluation::strings::normal_form::{StringSet, TrackString};
use serde::Serialize;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    Correct,
    Missed,
    False,
}

/// Where a truth string and the track that speaks for it first differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    pub position: usize,
    /// Index of the truth string.
    pub string: usize,
    /// Index of the output string that speaks; `None` when no track began as the truth string does.
    pub speaker: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetVerdict {
    pub verdict: Verdict,
    /// Of a false target, the difference in its first string that is not correct.
    pub first: Option<Difference>,
    pub errors: usize,
    /// Of a correct target.
    pub ln_weight: Option<f64>,
}

/// Judges truth strings against the automaton of the output strings.
pub struct Judge<'a> {
    pub truth: &'a StringSet,
    pub outputs: &'a StringSet,
    pub automaton: &'a Automaton,
    pub beginnings: &'a Beginnings,
    /// Rank of each track's id.
    pub track_ranks: &'a [u32],
}

impl Judge<'_> {
    pub fn target(&self, owner: usize) -> TargetVerdict {
        let mut judged = TargetVerdict { verdict: Verdict::Missed, first: None, errors: 0, ln_weight: None };
        for (count, index) in self.truth.of_owner(owner).enumerate() {
            let one = self.string(index);
            judged.verdict = if count == 0 || judged.verdict == one.verdict { one.verdict } else { Verdict::False };
            judged.first = judged.first.or(one.first);
            judged.errors += one.errors;
            judged.ln_weight = if count == 0 { one.ln_weight } else { judged.ln_weight.zip(one.ln_weight).map(|(a, b)| a + b) };
        }
        if judged.verdict != Verdict::False {
            judged.first = None;
        }
        judged
    }

    fn string(&self, index: usize) -> TargetVerdict {
        let string = &self.truth.strings()[index];
        match self.automaton.run(string.start, self.truth.steps_of(string)) {
            Run::Accepted { ln_weight } => TargetVerdict { verdict: Verdict::Correct, first: None, errors: 0, ln_weight: Some(ln_weight) },
            Run::NeverLeft => {
                let first = Difference { position: string.start, string: index, speaker: None };
                TargetVerdict { verdict: Verdict::Missed, first: Some(first), errors: string.real, ln_weight: None }
            }
            Run::Rejected => self.rejected(index, string),
        }
    }

    /// Of the tracks that begin as the string does, the one that follows it longest speaks, then the smaller id.
    fn rejected(&self, index: usize, string: &TrackString) -> TargetVerdict {
        let followers = self.beginnings.alike(self.outputs, self.truth, string);
        let differing = followers.filter_map(|output| {
            let track = &self.outputs.strings()[output];
            let position = self.differences(string, track).next()?;
            Some((position, std::cmp::Reverse((self.track_ranks[track.owner as usize], track.part)), output))
        });
        let speaking = differing.max();
        let first = speaking.map(|(position, _, output)| Difference { position, string: index, speaker: Some(output) });
        let errors = speaking.map_or(string.real, |(.., output)| self.differences(string, &self.outputs.strings()[output]).count());
        TargetVerdict { verdict: Verdict::False, first, errors, ln_weight: None }
    }

    /// The places at which a truth string and an output string that begin together differ.
    fn differences(&self, truth: &TrackString, output: &TrackString) -> impl Iterator<Item = usize> {
        let places = truth.start..truth.end().max(output.end());
        places.filter(|&position| self.truth.symbol_at(truth, position) != self.outputs.symbol_at(output, position))
    }
}
