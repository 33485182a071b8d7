//! Initial centres from the objects themselves, or from first memberships.

use super::metric::CentreUpdate;
use super::{Fuzzifier, FuzzyError, Objects, check_clusters};
use rand::seq::index::sample;
use rand::{Rng, RngExt};

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

/// U⁽⁰⁾ at random: of each object c numbers uniform on (0, 1], divided by their sum, at `k * c + i`.
///
/// # Errors
/// c outside 2 to n.
pub fn random_memberships(
    objects: usize,
    clusters: usize,
    stream: &mut impl Rng,
    memberships: &mut Vec<f64>,
) -> Result<(), FuzzyError> {
    check_clusters(clusters, objects)?;
    memberships.clear();
    memberships.extend((0..objects * clusters).map(|_| 1.0 - stream.random::<f64>()));
    for row in memberships.chunks_exact_mut(clusters) {
        let sum: f64 = row.iter().sum();
        row.iter_mut().for_each(|membership| *membership /= sum);
    }
    Ok(())
}

/// The centres that fit memberships best, u_ik at `k * c + i`; angles are averaged around those of the first object. With them a
/// run goes on as if it had begun with these memberships.
///
/// # Errors
/// c outside 2 to n; memberships that are not c for each object.
pub fn of_memberships(
    objects: &Objects,
    fuzzifier: Fuzzifier,
    memberships: &[f64],
    centres: &mut Vec<f64>,
) -> Result<(), FuzzyError> {
    let clusters = memberships.len() / objects.len().max(1);
    check_clusters(clusters, objects.len())?;
    if !memberships.len().is_multiple_of(objects.len()) {
        return Err(FuzzyError::Length {
            field: "initial",
            found: memberships.len(),
            wanted: "as many memberships for each object as there are clusters",
        });
    }
    centres.clear();
    for _ in 0..clusters {
        centres.extend_from_slice(objects.object(0));
    }
    CentreUpdate::default().centres(objects, fuzzifier, memberships, centres);
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
    use super::super::{FuzzyCMeans, FuzzyCMeansSettings, Metric};
    use super::*;
    use crate::math::rng::{Purpose, Seed};

    #[test]
    fn centres_of_memberships_and_the_next_memberships_by_hand() {
        // q = 2. v = (1·0 + ¼·3 + 0·6) / (1 + ¼ + 0) = 0.6 and (0·0 + ¼·3 + 1·6) / (0 + ¼ + 1) = 5.4. Then of the object at 0:
        // 1/0.6² : 1/5.4² = 81 : 1; of the one between ½ each.
        let objects = Objects::new(&[0.0, 3.0, 6.0], &[false], Metric::Scaled(&[2.0])).unwrap();
        let mut centres = Vec::new();
        let first = [1.0, 0.0, 0.5, 0.5, 0.0, 1.0];
        of_memberships(&objects, Fuzzifier::new(2.0).unwrap(), &first, &mut centres).unwrap();
        assert!((centres[0] - 0.6).abs() < 1e-12 && (centres[1] - 5.4).abs() < 1e-12);
        let settings = FuzzyCMeansSettings {
            max_iterations: 1,
            ..Default::default()
        };
        let mut means = FuzzyCMeans::new(settings).unwrap();
        let mut shown = Vec::new();
        means
            .run_observed(&objects, &centres, |state| {
                shown.push(state.memberships.to_vec());
            })
            .unwrap();
        let expected = [81.0 / 82.0, 1.0 / 82.0, 0.5, 0.5, 1.0 / 82.0, 81.0 / 82.0];
        let close = |pair: (&f64, &f64)| (pair.0 - pair.1).abs() < 1e-12;
        assert!(shown[0].iter().zip(&expected).all(close), "{:?}", shown[0]);
    }

    #[test]
    fn centres_of_memberships_weigh_objects_by_their_information() {
        // Weights 1 and ¼ (q = 2), information 1 and 4: (0 + ¼·4·3) / (1 + ¼·4) = 1.5; the other centre has the second object alone: 3.
        let objects =
            Objects::new(&[0.0, 3.0], &[false], Metric::Mahalanobis(&[1.0, 4.0])).unwrap();
        let mut centres = Vec::new();
        let first = [1.0, 0.0, 0.5, 0.5];
        of_memberships(&objects, Fuzzifier::new(2.0).unwrap(), &first, &mut centres).unwrap();
        assert!((centres[0] - 1.5).abs() < 1e-12 && (centres[1] - 3.0).abs() < 1e-12);
        let refused = of_memberships(
            &objects,
            Fuzzifier::new(2.0).unwrap(),
            &[1.0; 5],
            &mut centres,
        );
        assert_eq!(refused.unwrap_err().field(), "initial");
    }

    #[test]
    fn memberships_at_random_sum_to_one_and_are_spread_as_their_kind() {
        let mut draw = Seed { seed: 1, run: 0 }.stream(Purpose::Clustering, 3, 0);
        let mut memberships = Vec::new();
        random_memberships(4000, 3, &mut draw, &mut memberships).unwrap();
        for row in memberships.chunks_exact(3) {
            assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(row.iter().all(|membership| *membership > 0.0));
        }
        // Of u₁ / (u₁ + u₂ + u₃) the mean is ⅓, and its standard error here 0.0025 at most.
        let mean = memberships.iter().step_by(3).sum::<f64>() / 4000.0;
        assert!((mean - 1.0 / 3.0).abs() < 0.01, "{mean}");
        assert!(random_memberships(3, 4, &mut draw, &mut memberships).is_err());
    }

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
