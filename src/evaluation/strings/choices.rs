//! What each step of a string may have been, where the tracks did not decide (`all_gated`).

use super::step::{EPSILON, StringStep};

/// Symbols and weights, those of one step in a row.
#[derive(Debug)]
pub struct Choices {
    /// Where the choices of each step begin, and the end.
    first: Vec<usize>,
    all: Vec<(u32, f64)>,
}

impl Default for Choices {
    /// One step without choices: the place before the first string.
    fn default() -> Self {
        Choices {
            first: vec![0, 0],
            all: Vec::new(),
        }
    }
}

impl Choices {
    /// Of the next step; when no others are given the step itself is the only choice.
    pub fn push(&mut self, step: StringStep, others: &[StringStep]) {
        let steps = if others.is_empty() {
            std::slice::from_ref(&step)
        } else {
            others
        };
        self.all.extend(
            steps
                .iter()
                .map(|step| (step.symbol.unwrap_or(EPSILON), step.weight)),
        );
        self.first.push(self.all.len());
    }

    pub fn at(&self, step: usize) -> &[(u32, f64)] {
        &self.all[self.first[step]..self.first[step + 1]]
    }
}
