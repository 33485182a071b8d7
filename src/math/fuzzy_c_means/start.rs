//! Initial centres from the objects themselves.

use super::{FuzzyError, Objects, check_clusters};
use rand::Rng;
use rand::seq::index::sample;

/// c different objects, drawn at random.
///
/// # Errors
/// c outside 2 to n.
pub fn random(
    objects: &Objects,
    clusters: usize,
    stream: &mut impl Rng,
    centres: &mut Vec<f64>,
) -> Result<(), FuzzyError> {
    check_clusters(clusters, objects.len())?;
    centres.clear();
    sample(stream, objects.len(), clusters)
        .iter()
        .for_each(|object| centres.extend_from_slice(objects.object(object)));
    Ok(())
}

/// Adds objects to `centres` until there are c: each time the one that is farthest from its nearest centre, of equals the
/// first. Without any centre it begins with the first object.
///
/// # Errors
/// c outside 2 to n.
pub fn farthest_first(
    objects: &Objects,
    clusters: usize,
    centres: &mut Vec<f64>,
) -> Result<(), FuzzyError> {
    check_clusters(clusters, objects.len())?;
    let attributes = objects.attributes();
    if centres.is_empty() {
        centres.extend_from_slice(objects.object(0));
    }
    let mut nearest = vec![f64::INFINITY; objects.len()];
    let mut measured = 0;
    loop {
        for centre in centres[measured..].chunks_exact(attributes) {
            for (object, nearest) in nearest.iter_mut().enumerate() {
                *nearest = nearest.min(objects.squared_distance(object, centre));
            }
        }
        if centres.len() >= clusters * attributes {
            return Ok(());
        }
        measured = centres.len();
        let farthest = (0..nearest.len())
            .rev()
            .max_by(|&left, &right| nearest[left].total_cmp(&nearest[right]));
        centres.extend_from_slice(objects.object(farthest.expect("there are two objects or more")));
    }
}

#[cfg(test)]
mod tests {
    use super::super::Metric;
    use super::*;

    #[test]
    fn the_farthest_object_is_next() {
        // From 0: 10 is farthest, then 4 (distance 4 from 0, 6 from 10), of 3 (3 from 0) and 4.
        let objects =
            Objects::new(&[0.0, 10.0, 3.0, 4.0], &[false], Metric::Scaled(&[1.0])).unwrap();
        let mut centres = Vec::new();
        farthest_first(&objects, 3, &mut centres).unwrap();
        assert_eq!(centres, [0.0, 10.0, 4.0]);
        let mut given = vec![3.5];
        farthest_first(&objects, 2, &mut given).unwrap();
        assert_eq!(given, [3.5, 10.0]);
    }
}
