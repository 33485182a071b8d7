//! Names to small numbers, without an allocation for a name seen before.

use crate::model::names::natural_order;
use std::collections::HashMap;

/// Numbers names in the order they are first seen. The map is only looked up, never walked.
#[derive(Default)]
pub struct Interner {
    names: Vec<String>,
    numbers: HashMap<String, u32>,
    latest: u32,
}

impl Interner {
    pub fn number(&mut self, name: &str) -> u32 {
        // Files repeat the name of the row before more often than not.
        if self
            .names
            .get(self.latest as usize)
            .is_some_and(|latest| latest == name)
        {
            return self.latest;
        }
        self.latest = match self.numbers.get(name) {
            Some(&number) => number,
            None => {
                let number = self.names.len() as u32;
                self.numbers.insert(name.to_owned(), number);
                self.names.push(name.to_owned());
                number
            }
        };
        self.latest
    }

    pub fn name(&self, number: u32) -> &str {
        &self.names[number as usize]
    }

    /// For each number, its place in the natural order of names.
    pub fn places(&self) -> Vec<u32> {
        let mut order: Vec<usize> = (0..self.names.len()).collect();
        order.sort_by(|&a, &b| natural_order(&self.names[a], &self.names[b]));
        let mut places = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            places[old] = new as u32;
        }
        places
    }

    /// The names in natural order, and where each number went.
    pub fn sorted(self) -> (Vec<String>, Vec<u32>) {
        let places = self.places();
        let mut sorted = vec![String::new(); places.len()];
        for (name, &place) in self.names.into_iter().zip(&places) {
            sorted[place as usize] = name;
        }
        (sorted, places)
    }

    /// The names in the order first seen.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The same.
    pub fn into_names(self) -> Vec<String> {
        self.names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_first_sight_and_sort_naturally() {
        let mut interner = Interner::default();
        let numbers: Vec<u32> = ["10", "2", "10", "2", "1"]
            .iter()
            .map(|name| interner.number(name))
            .collect();
        assert_eq!(numbers, [0, 1, 0, 1, 2]);
        assert_eq!(interner.name(1), "2");
        let (names, place) = interner.sorted();
        assert_eq!(names, ["1", "2", "10"]);
        assert_eq!(place, [2, 1, 0]);
    }
}
