//! Running a string through an automaton: which states can be reached, all at once (breadth first) or one way after the
//! other (depth first). Both find the same; of several ways to an end the most probable counts.

use serde::Deserialize;
use std::collections::BTreeMap;

/// Every automaton begins here.
pub const START: u32 = 0;

/// What a search needs to know of an automaton: δ and F.
pub trait Transitions {
    /// Calls `go` with the goal and the weight of each transition out of a state on a symbol at a time.
    fn each(&self, state: u32, time: u32, symbol: u32, go: impl FnMut(u32, f64));

    fn is_final(&self, state: u32) -> bool;
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    BreadthFirst,
    DepthFirst,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Run {
    /// No transition out of the start state on the first symbol.
    NeverLeft,
    /// Nowhere to go at some scan, or an end on a state that is not final.
    Rejected,
    /// Ended on a final state; the logarithm of the product of the weights along the best path there.
    Accepted { ln_weight: f64 },
}

/// A product of weights that does not run out of the range of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Product {
    factor: f64,
    ln: f64,
}

impl Product {
    const ONE: Product = Product {
        factor: 1.0,
        ln: 0.0,
    };

    #[inline]
    fn times(self, weight: f64) -> Product {
        let factor = self.factor * weight;
        if factor > 1e-200 {
            Product {
                factor,
                ln: self.ln,
            }
        } else {
            Product {
                factor: 1.0,
                ln: self.ln + factor.ln(),
            }
        }
    }

    fn ln(self) -> f64 {
        self.ln + self.factor.ln()
    }
}

/// Searches one string after another with the same memory.
#[derive(Debug)]
pub struct RunSearch {
    order: Order,
    present: Vec<(u32, Product)>,
    next: Vec<(u32, Product)>,
}

impl RunSearch {
    pub fn new(order: Order) -> Self {
        RunSearch {
            order,
            present: Vec::new(),
            next: Vec::new(),
        }
    }

    /// Feeds a string whose first symbol is at time `start`.
    pub fn run(&mut self, automaton: &impl Transitions, start: usize, symbols: &[u32]) -> Run {
        match self.order {
            Order::BreadthFirst => self.breadth_first(automaton, start as u32, symbols),
            Order::DepthFirst => depth_first(automaton, start as u32, symbols),
        }
    }

    /// All states that can be reached, symbol by symbol.
    fn breadth_first(&mut self, automaton: &impl Transitions, start: u32, symbols: &[u32]) -> Run {
        let RunSearch { present, next, .. } = self;
        present.clear();
        present.push((START, Product::ONE));
        for (offset, &symbol) in symbols.iter().enumerate() {
            next.clear();
            for &(state, product) in present.iter() {
                automaton.each(state, start + offset as u32, symbol, |to, weight| {
                    next.push((to, product.times(weight)))
                });
            }
            if next.is_empty() {
                return if offset == 0 {
                    Run::NeverLeft
                } else {
                    Run::Rejected
                };
            }
            if next.len() > 1 {
                keep_best_of_each_state(next);
            }
            std::mem::swap(present, next);
        }
        let ended = present
            .iter()
            .filter(|(state, _)| automaton.is_final(*state));
        accepted(ended.map(|(_, product)| product.ln()))
    }
}

fn keep_best_of_each_state(states: &mut Vec<(u32, Product)>) {
    states.sort_by(|a, b| a.0.cmp(&b.0).then_with(|| b.1.ln().total_cmp(&a.1.ln())));
    states.dedup_by_key(|(state, _)| *state);
}

fn accepted(ln_weights: impl Iterator<Item = f64>) -> Run {
    ln_weights
        .reduce(f64::max)
        .map_or(Run::Rejected, |ln_weight| Run::Accepted { ln_weight })
}

/// One way after the other to its end, never twice through the same state at the same symbol; then the best weight of
/// every place that was met, in order of symbols.
fn depth_first(automaton: &impl Transitions, start: u32, symbols: &[u32]) -> Run {
    let mut met = BTreeMap::from([((0, START), Some(Product::ONE))]);
    let mut open = vec![(0, START)];
    while let Some((offset, state)) = open.pop() {
        let Some(&symbol) = symbols.get(offset) else {
            continue;
        };
        automaton.each(state, start + offset as u32, symbol, |to, _| {
            let place = (offset + 1, to);
            met.entry(place).or_insert_with(|| {
                open.push(place);
                None
            });
        });
    }
    let places: Vec<(usize, u32)> = met.keys().copied().collect();
    if places.len() == 1 && !symbols.is_empty() {
        return Run::NeverLeft;
    }
    for &(offset, state) in places
        .iter()
        .take_while(|(offset, _)| *offset < symbols.len())
    {
        let Some(so_far) = met[&(offset, state)] else {
            continue;
        };
        automaton.each(
            state,
            start + offset as u32,
            symbols[offset],
            |to, weight| {
                if let Some(best) = met.get_mut(&(offset + 1, to)) {
                    let next = so_far.times(weight);
                    *best = Some(best.filter(|best| best.ln() >= next.ln()).unwrap_or(next));
                }
            },
        );
    }
    let ended = places
        .iter()
        .filter(|(offset, state)| *offset == symbols.len() && automaton.is_final(*state));
    accepted(ended.filter_map(|place| met[place]).map(Product::ln))
}
