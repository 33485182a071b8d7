//! Who ever meets whom: the distinct pairs of a truth and a track in a comparison, without a table of all with all.

use super::comparison::{Comparison, Pair};

/// Truths and tracks that are listed as a pair at one step at least.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Acquaintances {
    /// Truth and track, rising.
    pub ids: Vec<(u32, u32)>,
    /// For each pair of the comparison its place in `ids`.
    pub of_pair: Vec<u32>,
}

impl Acquaintances {
    /// Sorts the pairs by counting, first by track, then by truth; so the cost is in proportion to pairs and ids.
    pub fn new(comparison: &Comparison) -> Acquaintances {
        let ids_of = |pair: &Pair| {
            let truth = &comparison.truths[pair.truth as usize];
            (truth.id, comparison.tracks[pair.track as usize].id)
        };
        let all: Vec<(u32, u32)> = comparison.pairs.iter().map(ids_of).collect();
        let places: Vec<u32> = (0..all.len() as u32).collect();
        let by_track =
            sorted_by_counting(&places, comparison.track_ids.len(), |place| all[place].1);
        let order = sorted_by_counting(&by_track, comparison.truth_ids.len(), |place| all[place].0);
        let mut found = Acquaintances {
            ids: Vec::new(),
            of_pair: vec![0; all.len()],
        };
        for place in order {
            let ids = all[place as usize];
            if found.ids.last() != Some(&ids) {
                found.ids.push(ids);
            }
            found.of_pair[place as usize] = found.ids.len() as u32 - 1;
        }
        found
    }
}

/// The items in order of their keys, which are below `keys`; equal keys keep their order.
fn sorted_by_counting(items: &[u32], keys: usize, key: impl Fn(usize) -> u32) -> Vec<u32> {
    let mut places = vec![0u32; keys + 1];
    for &item in items {
        places[key(item as usize) as usize + 1] += 1;
    }
    for index in 1..places.len() {
        places[index] += places[index - 1];
    }
    let mut sorted = vec![0; items.len()];
    for &item in items {
        let place = &mut places[key(item as usize) as usize];
        sorted[*place as usize] = item;
        *place += 1;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::super::tests::{GONE, compare};
    use super::*;

    #[test]
    fn each_distinct_pair_is_listed_once_in_order() {
        let comparison = compare(
            &[("A", &[0.0, 0.0]), ("B", &[5.0, 5.0])],
            &[("T", &[1.0, 1.0]), ("U", &[50.0, 6.0]), ("V", &[GONE; 2])],
            10.0,
        );
        let found = Acquaintances::new(&comparison);
        assert_eq!(found.ids, [(0, 0), (0, 1), (1, 0), (1, 1)]);
        // Step 0: A–T, B–T; step 1: A–T, A–U, B–T, B–U.
        assert_eq!(found.of_pair, [0, 2, 0, 1, 2, 3]);
    }

    #[test]
    fn nobody_meets_nobody() {
        assert_eq!(
            Acquaintances::new(&compare(&[], &[], 10.0)),
            Acquaintances::default()
        );
    }
}
