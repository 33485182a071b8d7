//! The automaton itself: states, timed transitions, and running a string through it.
//!
//! Transitions are kept state by state, those of one state by (time, symbol), so that a run costs a search an input
//! symbol and no more. Out of the start state a transition may have any time, a track may be born at any scan; inside
//! a path each transition is one scan later than the one before.

use crate::evaluation::strings::normal_form::Step;

/// δ: on `symbol` (ε is `None`) at `time` (a place of the scan axis) go to state `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    pub time: usize,
    pub symbol: Option<u32>,
    pub weight: f64,
    pub to: u32,
}

/// A temporal finite automaton. State 0 is the start.
#[derive(Debug)]
pub struct Automaton {
    /// Where the transitions of each state begin, and the end.
    pub(super) first: Vec<usize>,
    pub(super) transitions: Vec<Transition>,
    pub(super) is_final: Vec<bool>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Run {
    /// No transition out of the start state on the first symbol.
    NeverLeft,
    /// Nowhere to go at some scan, or an end on a state that is not final.
    Rejected,
    /// Ended on a final state; the sum of the logarithms of the weights along the best path there.
    Accepted { ln_weight: f64 },
}

impl Automaton {
    pub const START: u32 = 0;

    /// The transitions out of a state on one symbol at one time.
    fn on(&self, state: u32, time: usize, symbol: Option<u32>) -> &[Transition] {
        let all = &self.transitions[self.first[state as usize]..self.first[state as usize + 1]];
        let from = all.partition_point(|transition| (transition.time, transition.symbol) < (time, symbol));
        let count = all[from..].partition_point(|transition| (transition.time, transition.symbol) == (time, symbol));
        &all[from..from + count]
    }

    /// Feeds a string whose first symbol is at `start`, all reachable states at once (breadth first).
    pub fn run(&self, start: usize, steps: &[Step]) -> Run {
        let mut present = vec![(Self::START, 0.0)];
        let mut next = Vec::new();
        for (offset, step) in steps.iter().enumerate() {
            for &(state, ln_weight) in &present {
                let going = self.on(state, start + offset, step.symbol).iter();
                next.extend(going.map(|transition| (transition.to, ln_weight + transition.weight.ln())));
            }
            if next.is_empty() {
                return if offset == 0 { Run::NeverLeft } else { Run::Rejected };
            }
            keep_best_of_each_state(&mut next);
            std::mem::swap(&mut present, &mut next);
            next.clear();
        }
        let ended = present.iter().filter(|(state, _)| self.is_final[*state as usize]);
        let best = ended.map(|&(_, ln_weight)| ln_weight).reduce(f64::max);
        best.map_or(Run::Rejected, |ln_weight| Run::Accepted { ln_weight })
    }
}

fn keep_best_of_each_state(states: &mut Vec<(u32, f64)>) {
    states.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    states.dedup_by_key(|(state, _)| *state);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn transition(time: usize, symbol: u32, weight: f64, to: u32) -> Transition {
        Transition { time, symbol: Some(symbol), weight, to }
    }

    /// Start –7→ 1 or 2, both –8→ 3 (final); two ways to the same state.
    fn diamond() -> Automaton {
        Automaton {
            first: vec![0, 2, 3, 4, 4],
            transitions: vec![transition(4, 7, 0.5, 1), transition(4, 7, 0.2, 2), transition(5, 8, 0.5, 3), transition(5, 8, 1.0, 3)],
            is_final: vec![false, false, false, true],
        }
    }

    #[test]
    fn of_two_ways_to_a_state_the_better_counts() {
        let steps = [Step::certain(7), Step::certain(8)];
        assert_eq!(diamond().run(4, &steps), Run::Accepted { ln_weight: 0.5_f64.ln() + 0.5_f64.ln() });
    }

    #[test]
    fn time_is_part_of_the_input() {
        let steps = [Step::certain(7), Step::certain(8)];
        assert_eq!(diamond().run(3, &steps), Run::NeverLeft);
        assert_eq!(diamond().run(4, &steps[..1]), Run::Rejected, "state 1 is not final");
        assert_eq!(diamond().run(4, &[Step::certain(7), Step::NOTHING]), Run::Rejected);
    }

    const STATES: u32 = 4;

    /// An automaton with any transitions whatever, several on one symbol included.
    fn any_automaton() -> impl Strategy<Value = Automaton> {
        let symbol = prop::option::of(0..2u32);
        let one = (0..STATES, 0..3usize, symbol, 1..9u32, 0..STATES);
        (prop::collection::vec(one, 0..40), prop::collection::vec(any::<bool>(), STATES as usize)).prop_map(|(mut all, is_final)| {
            all.sort_by_key(|&(from, time, symbol, ..)| (from, time, symbol));
            let first = (0..=STATES).map(|state| all.partition_point(|&(from, ..)| from < state)).collect();
            let transition = |(_, time, symbol, tenths, to)| Transition { time, symbol, weight: f64::from(tenths) / 10.0, to };
            Automaton { first, transitions: all.into_iter().map(transition).collect(), is_final }
        })
    }

    /// The best logarithm of all paths to a final state, each tried to its end, depth first.
    fn naive(automaton: &Automaton, state: u32, time: usize, steps: &[Step]) -> Option<f64> {
        let Some((step, rest)) = steps.split_first() else { return automaton.is_final[state as usize].then_some(0.0) };
        let out = &automaton.transitions[automaton.first[state as usize]..automaton.first[state as usize + 1]];
        let going = out.iter().filter(|transition| transition.time == time && transition.symbol == step.symbol);
        let ways = going.filter_map(|transition| Some(transition.weight.ln() + naive(automaton, transition.to, time + 1, rest)?));
        ways.reduce(f64::max)
    }

    proptest! {
        #[test]
        fn a_run_finds_what_trying_every_path_finds(
            automaton in any_automaton(), start in 0..2usize, symbols in prop::collection::vec(prop::option::of(0..2u32), 1..4),
        ) {
            let steps: Vec<Step> = symbols.iter().map(|&symbol| Step { symbol, weight: 1.0 }).collect();
            let out = &automaton.transitions[..automaton.first[1]];
            let leaves = out.iter().any(|transition| transition.time == start && transition.symbol == symbols[0]);
            match (automaton.run(start, &steps), naive(&automaton, Automaton::START, start, &steps)) {
                (Run::NeverLeft, None) => prop_assert!(!leaves),
                (Run::Rejected, None) => prop_assert!(leaves),
                (Run::Accepted { ln_weight }, Some(best)) => prop_assert!((ln_weight - best).abs() < 1e-12),
                (run, best) => prop_assert!(false, "{run:?} against {best:?}"),
            }
        }
    }
}
