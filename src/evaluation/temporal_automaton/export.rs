//! The automaton for other tools: as JSON, and as a graph for Graphviz.

use super::automaton::{Automaton, Transition};
use super::report::EPSILON;
use super::search::{START, Transitions};
use crate::evaluation::strings::{Strings, step};
use serde::Serialize;
use std::fmt::Write;

/// An automaton in the names that users read.
#[derive(Debug, Serialize)]
pub struct AutomatonFile {
    /// Minimised automata keep no weights.
    pub minimised: bool,
    pub start_state: u32,
    pub states: usize,
    pub final_states: Vec<u32>,
    pub transitions: Vec<TransitionLine>,
}

#[derive(Debug, Serialize)]
pub struct TransitionLine {
    pub from: u32,
    pub to: u32,
    /// Number and time of the scan; null for a scan that no file names.
    pub scan: Option<u32>,
    pub time_s: Option<f64>,
    pub symbol: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weight: Option<f64>,
}

impl AutomatonFile {
    pub fn new(automaton: &Automaton, minimised: bool, strings: &Strings) -> Self {
        let states = 0..automaton.states() as u32;
        let line = |from: u32, transition: &Transition| {
            let scan = strings.axis.scan_at(transition.time as usize);
            let symbol = transition.symbol;
            TransitionLine {
                from,
                to: transition.to,
                scan: scan.map(|scan| scan.number),
                time_s: scan.map(|scan| scan.time_s),
                symbol: if symbol == step::EPSILON {
                    EPSILON
                } else {
                    strings.name_of(symbol)
                }
                .to_owned(),
                weight: (!minimised).then_some(transition.weight),
            }
        };
        AutomatonFile {
            minimised,
            start_state: START,
            states: automaton.states(),
            final_states: states
                .clone()
                .filter(|&state| automaton.is_final(state))
                .collect(),
            transitions: states
                .flat_map(|from| {
                    automaton
                        .out_of(from)
                        .iter()
                        .map(move |transition| line(from, transition))
                })
                .collect(),
        }
    }

    /// A directed graph in Graphviz' language, from left to right; final states have two rings, edges read `scan: symbol`.
    pub fn dot(&self) -> String {
        let mut text = String::from("digraph automaton {\n  rankdir=LR;\n  node [shape=circle];\n");
        for state in &self.final_states {
            // Writing to a text cannot fail.
            let _ = writeln!(text, "  {state} [shape=doublecircle];");
        }
        for TransitionLine {
            from,
            to,
            scan,
            symbol,
            weight,
            ..
        } in &self.transitions
        {
            let scan = scan.map_or_else(String::new, |scan| format!("{scan}: "));
            let weight = weight
                .filter(|&weight| weight != 1.0)
                .map_or_else(String::new, |weight| format!(" ({weight})"));
            let label = format!("{scan}{symbol}{weight}")
                .replace('\\', "\\\\")
                .replace('"', "\\\"")
                .replace('\n', "\\n");
            let _ = writeln!(text, "  {from} -> {to} [label=\"{label}\"];");
        }
        text.push_str("}\n");
        text
    }
}
