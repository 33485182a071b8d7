//! Numbers in disjoint sets: each has a parent in its set, the root of a set is its own, and is the least of its numbers.

/// Sets of one number each.
pub fn reset(parents: &mut Vec<u32>, numbers: usize) {
    parents.clear();
    parents.extend(0..numbers as u32);
}

/// The root of a number's set; the way there becomes shorter.
#[inline]
pub fn root(parents: &mut [u32], mut number: u32) -> u32 {
    while parents[number as usize] != number {
        let above = parents[parents[number as usize] as usize];
        parents[number as usize] = above;
        number = above;
    }
    number
}

/// Makes the sets of two numbers one.
#[inline]
pub fn join(parents: &mut [u32], one: u32, other: u32) {
    let (one, other) = (root(parents, one), root(parents, other));
    parents[one.max(other) as usize] = one.min(other);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_of_a_set_is_its_least_number() {
        let mut parents = Vec::new();
        reset(&mut parents, 7);
        for (one, other) in [(5, 3), (6, 5), (1, 2), (2, 1), (6, 2)] {
            join(&mut parents, one, other);
        }
        let roots: Vec<u32> = (0..7).map(|number| root(&mut parents, number)).collect();
        assert_eq!(roots, [0, 1, 1, 1, 4, 1, 1]);
    }
}
