//! When a cell has runs enough before all are done: the interval of one outcome is narrow enough at 10, 20, 40, 80, … runs.
//!
//! It is looked at so rarely because each look is one more chance to stop at an interval that is narrow by luck, and at fixed numbers of
//! runs so that the answer depends on the spec alone.

use super::outcomes::{Outcome, Rows};
use super::spec::Spec;
use crate::math::rng::{Purpose, Seed};
use crate::model::fault::Fault;
use serde::{Deserialize, Serialize};

/// Runs before the first look; each later one is at twice as many.
const FIRST_LOOK: u32 = 10;

/// Why a cell has no more runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ended {
    Runs,
    HalfWidth,
    NotYet,
}

#[derive(Debug)]
pub(super) struct Stop {
    number: usize,
    outcome: Outcome,
    half_width: f64,
    confidence: f64,
    seed: Seed,
}

/// After how many of at most `runs` runs the intervals are looked at, and at last `runs`.
pub(super) fn looks(runs: u32) -> impl Iterator<Item = u32> {
    let doubled = std::iter::successors(Some(FIRST_LOOK), |look| look.checked_mul(2));
    doubled.take_while(move |&look| look < runs).chain([runs])
}

impl Stop {
    /// The rule of a request, where it has one.
    ///
    /// # Errors
    /// It names an outcome that is not listed.
    pub fn new(spec: &Spec) -> Result<Option<Stop>, Box<Fault>> {
        let Some(rule) = &spec.stop_at else {
            return Ok(None);
        };
        let (name, outcomes) = (&rule.outcome, spec.outcomes.as_deref().unwrap_or_default());
        let Some(number) = outcomes.iter().position(|outcome| outcome.name() == name) else {
            let known: Vec<&str> = outcomes.iter().map(Outcome::name).collect();
            let allowed = if known.is_empty() {
                "an outcome listed in 'outcomes'".to_owned()
            } else {
                known.join(", ")
            };
            let detail = format!("there is no outcome '{name}' in the list of outcomes");
            return Err(Box::new(
                Fault::new("/stop_at/outcome", "unknown_value", detail).allowing(allowed),
            ));
        };
        Ok(Some(Stop {
            number,
            outcome: outcomes[number].clone(),
            half_width: rule.half_width,
            confidence: spec.confidence,
            seed: Seed {
                seed: spec.seed,
                run: 0,
            },
        }))
    }

    /// Whether the numbers of the first `runs` runs of a cell tell enough. What varies not at all in the first runs tells nothing of how much it may, but by Wilson.
    pub fn is_reached(&self, cell: usize, rows: &Rows, runs: usize) -> bool {
        let present: Vec<f64> = rows[self.number]
            .iter()
            .take(runs)
            .flatten()
            .copied()
            .collect();
        let draw = self
            .seed
            .stream(Purpose::Bootstrap, cell as u64, self.number as u64);
        let half_width = self
            .outcome
            .interval_of(&present, self.confidence, draw)
            .map(|interval| (interval.high - interval.low) / 2.0);
        half_width.is_some_and(|half_width| 0.0 < half_width && half_width <= self.half_width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::request::draft::parse;
    use serde_json::json;

    #[test]
    fn intervals_are_looked_at_after_ten_runs_and_each_doubling() {
        let all = |runs: u32| looks(runs).collect::<Vec<_>>();
        assert_eq!(all(1000), [10, 20, 40, 80, 160, 320, 640, 1000]);
        assert_eq!(
            (all(3), all(10), all(11)),
            (vec![3], vec![10], vec![10, 11])
        );
    }

    #[test]
    fn a_half_width_by_hand_is_reached_or_not() {
        // 1 … 5: ± 1.963243 (t); 10 of 10 by Wilson: 0.722467 to 1, ± 0.138766.
        let stop = |interval: &str, half_width: f64| {
            let outcome = json!({"path": "a", "name": "n", "interval": interval});
            let stop_at = json!({"outcome": "n", "half_width": half_width});
            let spec = parse(&json!({
                "seed": 1, "base": {}, "runs": 10, "timed_runs": 0, "confidence": 0.95,
                "outcomes": [outcome], "stop_at": stop_at
            }));
            Stop::new(&spec).unwrap().unwrap()
        };
        let numbers = vec![[1.0, 2.0, 3.0, 4.0, 5.0].map(Some).to_vec()];
        assert_eq!(
            (
                stop("t", 1.9633).is_reached(0, &numbers, 5),
                stop("t", 1.9632).is_reached(0, &numbers, 5)
            ),
            (true, false)
        );
        let ones = vec![vec![Some(1.0); 10]];
        assert_eq!(
            (
                stop("wilson", 0.1388).is_reached(0, &ones, 10),
                stop("wilson", 0.1387).is_reached(0, &ones, 10)
            ),
            (true, false)
        );
        assert!(
            !stop("t", 1.0).is_reached(0, &ones, 10)
                && !stop("t", 1.0).is_reached(0, &vec![vec![None; 10]], 10)
        );
    }
}
