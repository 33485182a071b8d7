//! The automaton as a table: states, timed transitions, final states.
//!
//! Transitions are kept state by state, those of one state by (time, symbol), so that a run costs a search an input
//! symbol and no more. Out of the start state a transition may have any time, a track may be born at any scan; inside
//! a path each transition is one scan later than the one before.

use super::births::{Births, may_end};
use super::search::Transitions;
use crate::evaluation::strings::normal_form::StringSet;

/// δ: on `symbol` at `time` (a place of the scan axis) go to state `to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    pub time: u32,
    /// ε is [`crate::evaluation::strings::step::EPSILON`].
    pub symbol: u32,
    pub weight: f64,
    pub to: u32,
}

/// A temporal finite automaton. State 0 is the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Automaton {
    /// Where the transitions of each state begin, and the end.
    first: Vec<usize>,
    transitions: Vec<Transition>,
    is_final: Vec<bool>,
}

impl Automaton {
    /// From the transitions of each state and whether it is final.
    pub fn new(states: impl IntoIterator<Item = (Vec<Transition>, bool)>) -> Self {
        let mut automaton = Automaton {
            first: vec![0],
            transitions: Vec::new(),
            is_final: Vec::new(),
        };
        for (mut transitions, is_final) in states {
            transitions
                .sort_by_key(|transition| (transition.time, transition.symbol, transition.to));
            automaton.transitions.append(&mut transitions);
            automaton.end_state(is_final);
        }
        automaton
    }

    /// The automaton of the output strings: one path a string, the states of a string its own, in a row behind the start.
    pub fn of_strings(outputs: &StringSet, births: &Births) -> Self {
        let mut first_state = Vec::with_capacity(outputs.strings().len());
        let mut states = 1;
        for string in outputs.strings() {
            first_state.push(states as u32);
            states += string.steps().len();
        }
        let mut automaton = Automaton {
            first: Vec::with_capacity(states + 1),
            transitions: Vec::with_capacity(states),
            is_final: Vec::with_capacity(states),
        };
        automaton.first.push(0);
        for birth in births.all() {
            let step = outputs.strings()[birth.string as usize].first_step + birth.offset as usize;
            let weight = outputs.weight_of(step, birth.symbol).unwrap_or(0.0);
            let to = first_state[birth.string as usize] + birth.offset;
            automaton.transitions.push(Transition {
                time: birth.time,
                symbol: birth.symbol,
                weight,
                to,
            });
        }
        automaton.end_state(false);
        for (string, &first) in outputs.strings().iter().zip(&first_state) {
            for offset in 0..string.steps().len() {
                automaton.add_choices(
                    outputs,
                    string.start + offset + 1,
                    string.first_step + offset + 1,
                    first + offset as u32 + 1,
                    string.steps().end,
                );
                automaton.end_state(may_end(outputs, string, offset));
            }
        }
        automaton
    }

    /// The transitions on everything that the step at `time` may be; none behind the end of the string.
    fn add_choices(&mut self, outputs: &StringSet, time: usize, step: usize, to: u32, end: usize) {
        if step < end {
            let from = self.transitions.len();
            let time = time as u32;
            self.transitions
                .extend(outputs.choices_at(step).map(|(symbol, weight)| Transition {
                    time,
                    symbol,
                    weight,
                    to,
                }));
            self.transitions[from..].sort_by_key(|transition| transition.symbol);
        }
    }

    /// Closes a state: every transition added since the last one is its.
    fn end_state(&mut self, is_final: bool) {
        self.first.push(self.transitions.len());
        self.is_final.push(is_final);
    }

    pub fn states(&self) -> usize {
        self.is_final.len()
    }

    pub fn transitions(&self) -> usize {
        self.transitions.len()
    }

    pub fn out_of(&self, state: u32) -> &[Transition] {
        &self.transitions[self.first[state as usize]..self.first[state as usize + 1]]
    }
}

impl Transitions for Automaton {
    fn each(&self, state: u32, time: u32, symbol: u32, mut go: impl FnMut(u32, f64)) {
        let all = self.out_of(state);
        let from =
            all.partition_point(|transition| (transition.time, transition.symbol) < (time, symbol));
        let here = all[from..]
            .iter()
            .take_while(|transition| (transition.time, transition.symbol) == (time, symbol));
        here.for_each(|transition| go(transition.to, transition.weight));
    }

    fn is_final(&self, state: u32) -> bool {
        self.is_final[state as usize]
    }
}
