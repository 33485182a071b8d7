//! The strict verdict on each target, with the record of its first error.
//!
//! A truth string is *missed* when the automaton never left the start state, *correct* when it is accepted, else
//! *false*. A target is correct if all its strings are, missed if all are (or if it has none), else false. Its errors
//! are the scans at which its strings and the tracks that speak for them differ; a missed string counts its own real
//! symbols.

use super::births::Births;
use super::search::{Run, RunSearch, Transitions};
use crate::evaluation::strings::difference::differences;
use crate::evaluation::strings::normal_form::{StringSet, TrackString};
use serde::Serialize;
use std::cmp::Reverse;

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

/// The strings that are judged and those that they are judged by.
#[derive(Clone, Copy)]
pub struct Sides<'a> {
    pub truth: &'a StringSet,
    pub outputs: &'a StringSet,
    pub births: &'a Births,
    /// Rank of each track's id.
    pub track_ranks: &'a [u32],
}

/// The verdict on every target.
pub fn judge(
    sides: Sides,
    automaton: &impl Transitions,
    search: &mut RunSearch,
) -> Vec<TargetVerdict> {
    (0..sides.truth.owners())
        .map(|owner| target(sides, automaton, search, owner))
        .collect()
}

fn target(
    sides: Sides,
    automaton: &impl Transitions,
    search: &mut RunSearch,
    owner: usize,
) -> TargetVerdict {
    let mut judged = TargetVerdict {
        verdict: Verdict::Missed,
        first: None,
        errors: 0,
        ln_weight: None,
    };
    for (count, index) in sides.truth.of_owner(owner).enumerate() {
        let string = &sides.truth.strings()[index];
        let run = search.run(automaton, string.start, sides.truth.symbols_of(string));
        let one = sides.verdict_of(index, run);
        judged.verdict = if count == 0 || judged.verdict == one.verdict {
            one.verdict
        } else {
            Verdict::False
        };
        judged.first = judged.first.or(one.first);
        judged.errors += one.errors;
        judged.ln_weight = if count == 0 {
            one.ln_weight
        } else {
            judged.ln_weight.zip(one.ln_weight).map(|(a, b)| a + b)
        };
    }
    if judged.verdict != Verdict::False {
        judged.first = None;
    }
    judged
}

/// The track that speaks for a truth string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speaker {
    /// Index of the output string.
    pub output: usize,
    /// Where the two first differ; `None` when they never do.
    pub differs_at: Option<usize>,
}

impl Speaker {
    /// How long the two agree.
    fn length(&self) -> usize {
        self.differs_at.unwrap_or(usize::MAX)
    }
}

impl<'a> Sides<'a> {
    fn verdict_of(&self, index: usize, run: Run) -> TargetVerdict {
        let string = &self.truth.strings()[index];
        match run {
            Run::Accepted { ln_weight } => TargetVerdict {
                verdict: Verdict::Correct,
                first: None,
                errors: 0,
                ln_weight: Some(ln_weight),
            },
            Run::NeverLeft => {
                let first = Difference {
                    position: string.start,
                    string: index,
                    speaker: None,
                };
                TargetVerdict {
                    verdict: Verdict::Missed,
                    first: Some(first),
                    errors: string.real,
                    ln_weight: None,
                }
            }
            Run::Rejected => {
                let speaking = self.speaker(string);
                let differing = speaking.and_then(|it| Some((it.output, it.differs_at?)));
                let first = differing.map(|(output, position)| Difference {
                    position,
                    string: index,
                    speaker: Some(output),
                });
                let errors = differing.map_or(string.real, |(output, from)| {
                    self.differences(string, output, from).count()
                });
                TargetVerdict {
                    verdict: Verdict::False,
                    first,
                    errors,
                    ln_weight: None,
                }
            }
        }
    }

    /// Of the tracks that begin as a truth string does, the one that follows it longest speaks, then the more probable one,
    /// then the one with the smaller id.
    pub fn speaker(&self, string: &'a TrackString) -> Option<Speaker> {
        let first = *self.truth.symbols_of(string).first()?;
        let followers = self
            .births
            .on(string.start as u32, first)
            .iter()
            .map(|birth| birth.string as usize);
        let mut best: Option<(Speaker, Reverse<(u32, u32)>)> = None;
        for output in followers {
            let track = &self.outputs.strings()[output];
            let differs_at = self.differences(string, output, string.start).next();
            let next = (
                Speaker { output, differs_at },
                Reverse((self.track_ranks[track.owner as usize], track.part)),
            );
            if best.is_none_or(|kept| self.is_better(string, &next, &kept)) {
                best = Some(next);
            }
        }
        best.map(|(speaker, _)| speaker)
    }

    fn is_better(
        &self,
        string: &TrackString,
        next: &(Speaker, Reverse<(u32, u32)>),
        kept: &(Speaker, Reverse<(u32, u32)>),
    ) -> bool {
        let by_length = next.0.length().cmp(&kept.0.length());
        let by_weight = || match (next.0.differs_at, kept.0.differs_at) {
            (None, None) => self
                .ln_weight(string, next.0.output)
                .total_cmp(&self.ln_weight(string, kept.0.output)),
            _ => std::cmp::Ordering::Equal,
        };
        by_length
            .then_with(by_weight)
            .then(next.1.cmp(&kept.1))
            .is_gt()
    }

    fn ln_weight(&self, string: &TrackString, output: usize) -> f64 {
        let symbols = self.truth.symbols_of(string).iter().enumerate();
        let track = &self.outputs.strings()[output];
        symbols
            .map(|(offset, &symbol)| {
                self.outputs
                    .weight_at(track, string.start + offset, symbol)
                    .unwrap_or(0.0)
                    .ln()
            })
            .sum()
    }

    /// The places from `from` on at which a truth string is what the output string cannot have been.
    fn differences(
        &self,
        truth: &'a TrackString,
        output: usize,
        from: usize,
    ) -> impl Iterator<Item = usize> + 'a {
        let output = &self.outputs.strings()[output];
        differences(
            (self.truth, truth),
            (self.outputs, output),
            from..truth.end().max(output.end()),
        )
    }
}
