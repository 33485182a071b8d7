//! Which of two names is the smaller: whole numbers by value, before all other names, those in text order.

/// The rank of each name among all of them, from 0; equal names keep their order of listing.
pub fn ranks<'a>(names: impl Iterator<Item = &'a str>) -> Vec<u32> {
    let keys: Vec<(bool, u64, &str)> = names.map(key).collect();
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by_key(|&index| keys[index]);
    let mut ranks = vec![0; keys.len()];
    for (rank, index) in order.into_iter().enumerate() {
        ranks[index] = rank as u32;
    }
    ranks
}

fn key(name: &str) -> (bool, u64, &str) {
    match name.parse::<u64>() {
        Ok(value) => (false, value, name),
        Err(_) => (true, 0, name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_by_value_and_before_words() {
        assert_eq!(
            ranks(["10", "b", "2", "a", "2"].into_iter()),
            [2, 4, 0, 3, 1]
        );
    }
}
