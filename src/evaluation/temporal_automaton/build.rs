//! Builds the automaton from the output strings: one path a string, one final state at its end.

use super::automaton::{Automaton, Transition};
use crate::evaluation::strings::normal_form::{StringSet, TrackString};

/// The output strings in the order of (place, symbol) of their beginnings: who begins with what.
pub struct Beginnings(Vec<u32>);

impl Beginnings {
    pub fn new(outputs: &StringSet) -> Self {
        let mut order: Vec<u32> = (0..outputs.strings().len() as u32).collect();
        order.sort_by_key(|&index| beginning(outputs, &outputs.strings()[index as usize]));
        Beginnings(order)
    }

    /// Indices of the output strings that begin as `string` of `set` does.
    pub fn alike<'b>(&'b self, outputs: &'b StringSet, set: &StringSet, string: &TrackString) -> impl Iterator<Item = usize> + 'b {
        let wanted = beginning(set, string);
        let from = self.0.partition_point(|&index| beginning(outputs, &outputs.strings()[index as usize]) < wanted);
        let behind = self.0[from..].iter().map(|&index| index as usize);
        behind.take_while(move |&index| beginning(outputs, &outputs.strings()[index]) == wanted)
    }
}

fn beginning(set: &StringSet, string: &TrackString) -> (usize, Option<u32>) {
    (string.start, set.symbol_at(string, string.start))
}

/// The automaton that accepts exactly the output strings.
pub fn build(outputs: &StringSet, beginnings: &Beginnings) -> Automaton {
    let strings = outputs.strings();
    // The states of a string are its own, in a row; state 0 is the common start.
    let mut first_state = Vec::with_capacity(strings.len());
    let mut states = 1;
    for string in strings {
        first_state.push(states as u32);
        states += string.end() - string.start;
    }
    let mut automaton =
        Automaton { first: Vec::with_capacity(states + 1), transitions: Vec::with_capacity(states), is_final: vec![false; states] };
    automaton.first.push(0);
    for &index in &beginnings.0 {
        automaton.transitions.push(transition(outputs, &strings[index as usize], 0, first_state[index as usize]));
    }
    for (string, &state) in strings.iter().zip(&first_state) {
        add_path(&mut automaton, outputs, string, state);
    }
    automaton.first.push(automaton.transitions.len());
    automaton
}

/// The states of one string from the first behind the start, with the transitions between them.
fn add_path(automaton: &mut Automaton, outputs: &StringSet, string: &TrackString, state: u32) {
    let len = string.end() - string.start;
    for offset in 1..len {
        automaton.first.push(automaton.transitions.len());
        automaton.transitions.push(transition(outputs, string, offset, state + offset as u32));
    }
    automaton.first.push(automaton.transitions.len());
    automaton.is_final[state as usize + len - 1] = true;
}

fn transition(outputs: &StringSet, string: &TrackString, offset: usize, to: u32) -> Transition {
    let step = outputs.steps_of(string)[offset];
    Transition { time: string.start + offset, symbol: step.symbol, weight: step.weight, to }
}
