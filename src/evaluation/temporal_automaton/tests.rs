//! Random strings judged in every way that must agree.

use super::automaton::{Automaton, Transition};
use super::births::Births;
use super::determinise::{determinise, minimise};
use super::paths::Paths;
use super::search::{Order, Run, RunSearch, START, Transitions};
use crate::evaluation::strings::normal_form::StringSet;
use crate::evaluation::strings::step::{EPSILON, StringStep};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Strings of three symbols and ε over eight scans, one owner a line.
fn any_strings() -> impl Strategy<Value = StringSet> {
    let step = (prop::option::weighted(0.75, 0..3u32), 1..9u32);
    prop::collection::vec(prop::collection::vec(step, 0..8), 0..7).prop_map(|lines| {
        let mut set = StringSet::weighted(2, false);
        for line in lines {
            set.push_owner(
                line.into_iter()
                    .map(|(symbol, tenths)| StringStep {
                        symbol,
                        weight: f64::from(tenths) / 10.0,
                    })
                    .enumerate(),
            );
        }
        set
    })
}

/// The same with up to three choices a scan.
fn any_choices() -> impl Strategy<Value = StringSet> {
    let choice = (prop::option::weighted(0.6, 0..3u32), 1..9u32);
    prop::collection::vec(
        prop::collection::vec(prop::collection::vec(choice, 1..4), 0..6),
        0..5,
    )
    .prop_map(|lines| {
        let mut set = StringSet::weighted(2, true);
        for line in lines {
            for (position, scan) in line.into_iter().enumerate() {
                let by_symbol: BTreeMap<Option<u32>, u32> = scan.into_iter().collect();
                let choices: Vec<StringStep> = by_symbol
                    .into_iter()
                    .map(|(symbol, tenths)| StringStep {
                        symbol,
                        weight: f64::from(tenths) / 10.0,
                    })
                    .collect();
                set.push_step(position, choices[0], &choices);
            }
            set.end_owner();
        }
        set
    })
}

/// Automata without circles, whatever else they are.
fn any_automaton() -> impl Strategy<Value = Automaton> {
    const STATES: u32 = 6;
    let one = (0..STATES - 1, 0..3u32, 0..3u32, 1..9u32, 1..STATES);
    (
        prop::collection::vec(one, 0..30),
        prop::collection::vec(any::<bool>(), STATES as usize),
    )
        .prop_map(|(all, is_final)| {
            let transitions = |state: u32| {
                let own = all.iter().filter(move |&&(from, ..)| from == state);
                let forward = own.map(move |&(from, time, symbol, tenths, to)| Transition {
                    time,
                    symbol,
                    weight: f64::from(tenths) / 10.0,
                    to: to.max(from + 1),
                });
                forward.collect()
            };
            Automaton::new(
                (0..STATES)
                    .zip(&is_final)
                    .map(|(state, &is_final)| (transitions(state), is_final))
                    .collect::<Vec<_>>(),
            )
        })
}

type Word = Vec<(u32, u32)>;

/// Every timed word that leads from a state to an end.
fn language(automaton: &Automaton, state: u32) -> BTreeSet<Word> {
    let mut words = BTreeSet::new();
    if automaton.is_final(state) {
        words.insert(Vec::new());
    }
    for transition in automaton.out_of(state) {
        for mut word in language(automaton, transition.to) {
            word.insert(0, (transition.time, transition.symbol));
            words.insert(word);
        }
    }
    words
}

/// The best logarithm of all paths to a final state, each tried to its end.
fn naive(automaton: &Automaton, state: u32, time: u32, symbols: &[u32]) -> Option<f64> {
    let Some((&symbol, rest)) = symbols.split_first() else {
        return automaton.is_final(state).then_some(0.0);
    };
    let going = automaton
        .out_of(state)
        .iter()
        .filter(|transition| (transition.time, transition.symbol) == (time, symbol));
    let ways = going.filter_map(|transition| {
        Some(transition.weight.ln() + naive(automaton, transition.to, time + 1, rest)?)
    });
    ways.reduce(f64::max)
}

fn run(order: Order, automaton: &impl Transitions, start: usize, symbols: &[u32]) -> Run {
    RunSearch::new(order).run(automaton, start, symbols)
}

fn are_the_same(a: Run, b: Run) -> bool {
    match (a, b) {
        (Run::Accepted { ln_weight: a }, Run::Accepted { ln_weight: b }) => (a - b).abs() < 1e-9,
        _ => a == b,
    }
}

fn any_word() -> impl Strategy<Value = Vec<u32>> {
    prop::collection::vec(prop_oneof![3 => 0..3u32, 1 => Just(EPSILON)], 1..6)
}

/// Whether the line of an owner can be read so that the word is one of its strings.
fn reads(lines: &[Vec<u32>], max_missed: usize, start: usize, word: &[u32]) -> bool {
    lines.iter().any(|line| {
        let mut set = StringSet::new(max_missed as u32);
        set.push_owner(
            line.iter()
                .map(|&symbol| StringStep {
                    symbol: Some(symbol).filter(|&it| it != EPSILON),
                    weight: 1.0,
                })
                .enumerate(),
        );
        set.strings()
            .iter()
            .any(|string| string.start == start && set.symbols_of(string) == word)
    })
}

/// Every line that choosing one of the choices at each scan gives.
fn readings(set: &StringSet) -> Vec<Vec<u32>> {
    let mut all = Vec::new();
    for string in set.strings() {
        let mut lines = vec![vec![EPSILON; string.start]];
        for step in string.steps() {
            let choices: Vec<u32> = set.choices_at(step).map(|(symbol, _)| symbol).collect();
            lines = lines
                .iter()
                .flat_map(|line| {
                    choices
                        .iter()
                        .map(|&choice| [line.as_slice(), &[choice]].concat())
                })
                .collect();
        }
        all.append(&mut lines);
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn both_searches_find_what_trying_every_path_finds(automaton in any_automaton(), start in 0..3usize, symbols in any_word()) {
        let leaves = automaton.out_of(START).iter().any(|it| (it.time, it.symbol) == (start as u32, symbols[0]));
        let expected = match naive(&automaton, START, start as u32, &symbols) {
            Some(ln_weight) => Run::Accepted { ln_weight },
            None if leaves => Run::Rejected,
            None => Run::NeverLeft,
        };
        for order in [Order::BreadthFirst, Order::DepthFirst] {
            let found = run(order, &automaton, start, &symbols);
            prop_assert!(are_the_same(found, expected), "{order:?}: {found:?} against {expected:?}");
        }
    }

    #[test]
    fn the_strings_themselves_are_the_automaton_of_the_table(outputs in any_strings(), start in 0..4usize, word in any_word()) {
        let births = Births::new(&outputs);
        let table = Automaton::of_strings(&outputs, &births);
        let paths = Paths { outputs: &outputs, births: &births };
        let own = outputs.strings().iter().map(|string| (string.start, outputs.symbols_of(string).to_vec()));
        for (start, word) in own.chain([(start, word)]) {
            let accepted = outputs.strings().iter().any(|string| string.start == start && outputs.symbols_of(string) == word);
            let expected = run(Order::BreadthFirst, &table, start, &word);
            prop_assert_eq!(matches!(expected, Run::Accepted { .. }), accepted);
            for order in [Order::BreadthFirst, Order::DepthFirst] {
                prop_assert!(are_the_same(run(order, &paths, start, &word), expected));
            }
        }
    }

    #[test]
    fn minimised_automata_accept_exactly_the_same_and_have_no_two_states_alike(automaton in any_automaton()) {
        let deterministic = determinise(&automaton, 10_000).unwrap();
        let minimal = minimise(&deterministic);
        let words = language(&automaton, START);
        prop_assert_eq!(&language(&deterministic, START), &words);
        prop_assert_eq!(&language(&minimal, START), &words);
        prop_assert!(minimal.states() <= deterministic.states());
        let rights: BTreeSet<BTreeSet<Word>> = (0..minimal.states() as u32).map(|state| language(&minimal, state)).collect();
        prop_assert_eq!(rights.len(), minimal.states());
        for state in 0..minimal.states() as u32 {
            let symbols: BTreeSet<(u32, u32)> = minimal.out_of(state).iter().map(|it| (it.time, it.symbol)).collect();
            prop_assert_eq!(symbols.len(), minimal.out_of(state).len(), "deterministic");
        }
    }

    #[test]
    fn the_minimal_automaton_of_strings_accepts_the_strings(outputs in any_strings()) {
        let table = Automaton::of_strings(&outputs, &Births::new(&outputs));
        let minimal = minimise(&determinise(&table, 10_000).unwrap());
        let words = |string| {
            let timed = outputs.symbols_of(string).iter().enumerate();
            timed.map(|(offset, &symbol)| ((string.start + offset) as u32, symbol)).collect::<Word>()
        };
        let strings: BTreeSet<Word> = outputs.strings().iter().map(words).collect();
        prop_assert_eq!(language(&minimal, START), strings);
        prop_assert!(minimal.states() <= table.states());
    }

    #[test]
    fn with_choices_every_reading_of_a_track_is_accepted_and_nothing_else(
        outputs in any_choices(), start in 0..4usize, word in prop::collection::vec(prop_oneof![3 => 0..3u32, 1 => Just(EPSILON)], 1..5),
    ) {
        // Words in normal form, as truth strings are.
        prop_assume!(word[0] != EPSILON && word[word.len() - 1] != EPSILON && !word.windows(2).any(|pair| pair == [EPSILON; 2]));
        let table = Automaton::of_strings(&outputs, &Births::new(&outputs));
        let accepted = matches!(run(Order::BreadthFirst, &table, start, &word), Run::Accepted { .. });
        prop_assert_eq!(accepted, reads(&readings(&outputs), outputs.max_missed(), start, &word));
    }
}

#[test]
fn more_states_than_allowed_are_not_made() {
    let mut set = StringSet::new(5);
    set.push_owner((0..9).map(|position| (position, StringStep::certain(position as u32))));
    let table = Automaton::of_strings(&set, &Births::new(&set));
    assert_eq!((table.states(), table.transitions()), (10, 9));
    assert!(determinise(&table, 9).is_none());
    assert_eq!(
        determinise(&table, 10),
        Some(Automaton::new(
            (0..10).map(|state| (table.out_of(state).to_vec(), state == 9))
        ))
    );
}

#[test]
fn strings_that_begin_and_end_alike_share_states() {
    let mut set = StringSet::new(5);
    for middle in [7, 8] {
        set.push_owner(
            [1, middle, 2]
                .into_iter()
                .map(StringStep::certain)
                .enumerate(),
        );
    }
    let table = Automaton::of_strings(&set, &Births::new(&set));
    let minimal = minimise(&determinise(&table, 100).unwrap());
    assert_eq!((table.states(), table.transitions()), (7, 6));
    assert_eq!((minimal.states(), minimal.transitions()), (4, 4));
}

#[test]
fn very_long_products_do_not_vanish() {
    let mut set = StringSet::weighted(5, false);
    set.push_owner((0..5000).map(|position| {
        (
            position,
            StringStep {
                symbol: Some(1),
                weight: 0.5,
            },
        )
    }));
    let births = Births::new(&set);
    let found = run(
        Order::BreadthFirst,
        &Paths {
            outputs: &set,
            births: &births,
        },
        0,
        &[1; 5000],
    );
    let Run::Accepted { ln_weight } = found else {
        panic!("{found:?}")
    };
    assert!((ln_weight - 5000.0 * 0.5_f64.ln()).abs() < 1e-8);
}
