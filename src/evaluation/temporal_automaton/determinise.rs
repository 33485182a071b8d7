//! The same language with at most one transition for each (state, time, symbol), and then with the fewest states.
//!
//! # Reference
//! M. O. Rabin, D. Scott, Finite automata and their decision problems, IBM Journal 3, 1959 (the subset construction);
//! D. Revuz, Minimisation of acyclic deterministic automata in linear time, Theoretical Computer Science 92, 1992.
//!
//! # Method
//! 1. A state of the deterministic automaton is the set of states that the same timed symbols lead to.
//! 2. Time only goes forward, so there are no circles: states are compared from the ends of the strings backwards. Two
//!    states are one when both are final or both are not and they have the same transitions to the same states.
//!
//! Only which strings are accepted is kept, not how probable they are: all weights are 1.

use super::automaton::{Automaton, Transition};
use super::search::{START, Transitions};
use std::collections::{BTreeMap, BTreeSet};

/// The states that the same timed symbols lead to, by the time and the symbol.
type Goals = BTreeMap<(u32, u32), BTreeSet<u32>>;

/// A deterministic automaton of the same language; `None` when it would have more than `max_states`.
pub fn determinise(automaton: &Automaton, max_states: usize) -> Option<Automaton> {
    let start = vec![START];
    let mut number_of = BTreeMap::from([(start.clone(), START)]);
    let mut sets = vec![start];
    let mut states = Vec::new();
    while states.len() < sets.len() {
        let set = sets[states.len()].clone();
        let mut transitions = Vec::new();
        for ((time, symbol), goals) in goals_of(automaton, &set) {
            let goals: Vec<u32> = goals.into_iter().collect();
            let to = *number_of.entry(goals).or_insert_with_key(|goals| {
                sets.push(goals.clone());
                sets.len() as u32 - 1
            });
            transitions.push(Transition {
                time,
                symbol,
                weight: 1.0,
                to,
            });
        }
        if sets.len() > max_states {
            return None;
        }
        states.push((
            transitions,
            set.iter().any(|&state| automaton.is_final(state)),
        ));
    }
    Some(Automaton::new(states))
}

fn goals_of(automaton: &Automaton, set: &[u32]) -> Goals {
    let mut goals = Goals::new();
    for transition in set.iter().flat_map(|&state| automaton.out_of(state)) {
        goals
            .entry((transition.time, transition.symbol))
            .or_default()
            .insert(transition.to);
    }
    goals
}

/// What tells a state from others: whether it is final, and its transitions with the classes of their goals.
type Signature = (bool, Vec<(u32, u32, u32)>);

/// The automaton with the fewest states that accepts what a deterministic one without circles accepts.
pub fn minimise(automaton: &Automaton) -> Automaton {
    let mut class_of = vec![u32::MAX; automaton.states()];
    let mut classes: BTreeMap<Signature, u32> = BTreeMap::new();
    for state in ends_first(automaton) {
        let goal = |transition: &Transition| {
            (
                transition.time,
                transition.symbol,
                class_of[transition.to as usize],
            )
        };
        // What never leads to an end is no part of the language.
        let living: Vec<(u32, u32, u32)> = automaton
            .out_of(state)
            .iter()
            .map(goal)
            .filter(|&(.., class)| class != u32::MAX)
            .collect();
        if state == START || automaton.is_final(state) || !living.is_empty() {
            let next = classes.len() as u32;
            class_of[state as usize] = *classes
                .entry((automaton.is_final(state), living))
                .or_insert(next);
        }
    }
    renumber(classes, class_of[START as usize])
}

/// The states that can be reached, each behind all states that it leads to.
fn ends_first(automaton: &Automaton) -> Vec<u32> {
    let mut is_met = vec![false; automaton.states()];
    is_met[START as usize] = true;
    let mut order = Vec::new();
    // A state, and how many of its transitions were followed.
    let mut path = vec![(START, 0)];
    while let Some((state, followed)) = path.last_mut() {
        match automaton.out_of(*state).get(*followed) {
            Some(transition) => {
                *followed += 1;
                if !std::mem::replace(&mut is_met[transition.to as usize], true) {
                    path.push((transition.to, 0));
                }
            }
            None => {
                order.push(*state);
                path.pop();
            }
        }
    }
    order
}

/// The classes as an automaton: the start is state 0, the others in the order in which they are met from it.
fn renumber(classes: BTreeMap<Signature, u32>, start: u32) -> Automaton {
    let mut by_class: Vec<Signature> = vec![Signature::default(); classes.len()];
    for (signature, class) in classes {
        by_class[class as usize] = signature;
    }
    let mut number_of = vec![u32::MAX; by_class.len()];
    number_of[start as usize] = START;
    let mut order = vec![start];
    let mut states = Vec::with_capacity(by_class.len());
    while states.len() < order.len() {
        let (is_final, transitions) = std::mem::take(&mut by_class[order[states.len()] as usize]);
        let renumber = |(time, symbol, class): (u32, u32, u32)| {
            let number = &mut number_of[class as usize];
            if *number == u32::MAX {
                *number = order.len() as u32;
                order.push(class);
            }
            Transition {
                time,
                symbol,
                weight: 1.0,
                to: *number,
            }
        };
        let transitions = transitions.into_iter().map(renumber).collect();
        states.push((transitions, is_final));
    }
    Automaton::new(states)
}
