//! Detections of one target in one scan put together: a sensor that resolves its targets gives several of each.
//!
//! # Method
//! Of a sensor with `merge_within_m` the detections of a scan that are not farther apart are linked, and so are those that a chain of such
//! links joins. Each cluster becomes one detection at its mean: of the coordinates that the sensor reports, bearings around the first.
//! The strongest amplitude stays; identity, time, noise and whatever else belongs to the first, its origin to the first that has one.

use crate::math::disjoint_sets;
use crate::model::angle::wrap;
use crate::model::beside::Beside;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::sensor::SensorSettings;
use crate::model::state::Position;
use std::collections::BTreeMap;

/// The recording with clusters put together, and how many detections became part of another; `known` are its sensors.
pub fn merged(recording: Recording, known: &[SensorSettings]) -> (Recording, Option<u64>) {
    if known.iter().all(|sensor| sensor.merge_within_m.is_none()) {
        return (recording, None);
    }
    let before = recording.detection_count();
    let mut parts = recording.clone().into_parts();
    let ids = std::mem::take(&mut parts.detection_ids);
    let beside = std::mem::take(&mut parts.beside);
    let RecordingParts {
        scans,
        detection_ids,
        beside: kept_beside,
        ..
    } = &mut parts;
    let mut first = 0;
    for scan in scans {
        let count = scan.detections.len();
        let kept = match known[scan.sensor].merge_within_m {
            Some(within_m) => merge_scan(scan, within_m),
            None => (0..count).collect(),
        };
        for index in kept {
            detection_ids.push(ids[first + index].clone());
            Beside::extend(kept_beside, &beside, first + index..first + index + 1);
        }
        first += count;
    }
    // What was sound stays so.
    let recording = Recording::new(parts).unwrap_or(recording);
    let merged = before - recording.detection_count();
    (recording, Some(merged as u64))
}

/// Puts the clusters of a scan together. Tells which detections stay.
fn merge_scan(scan: &mut Scan, within_m: f64) -> Vec<usize> {
    let mut clusters: BTreeMap<u32, Vec<Detection>> = BTreeMap::new();
    for (root, detection) in roots(scan, within_m).into_iter().zip(&scan.detections) {
        clusters.entry(root).or_default().push(*detection);
    }
    let kept: Vec<usize> = clusters.keys().map(|root| *root as usize).collect();
    scan.detections = clusters.values().map(|cluster| mean(cluster)).collect();
    if !scan.own.is_empty() {
        scan.own = kept.iter().map(|index| scan.own[*index]).collect();
    }
    kept
}

/// Of each detection the first of its cluster.
fn roots(scan: &Scan, within_m: f64) -> Vec<u32> {
    let places: Vec<Option<[f64; 3]>> = scan.detections.iter().map(place_m).collect();
    let mut parents = Vec::new();
    disjoint_sets::reset(&mut parents, places.len());
    let cell = |place: &[f64; 3]| place.map(|x_m| (x_m / within_m).floor() as i64);
    let mut cells: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
    for (index, place) in places.iter().enumerate() {
        if let Some(place) = place {
            for near in neighbours(cell(place)) {
                for other in cells.get(&near).into_iter().flatten() {
                    let there = places[*other as usize].unwrap_or(*place);
                    if squared_distance(place, &there) <= within_m * within_m {
                        disjoint_sets::join(&mut parents, index as u32, *other);
                    }
                }
            }
            cells.entry(cell(place)).or_default().push(index as u32);
        }
    }
    let numbers = 0..places.len() as u32;
    numbers
        .map(|number| disjoint_sets::root(&mut parents, number))
        .collect()
}

/// A cell and those that touch it.
fn neighbours(cell: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27_i64).map(move |number| {
        let steps = [number % 3, number / 3 % 3, number / 9];
        std::array::from_fn(|axis| cell[axis].saturating_add(steps[axis] - 1))
    })
}

fn squared_distance(one: &[f64; 3], other: &[f64; 3]) -> f64 {
    (0..3).map(|axis| (one[axis] - other[axis]).powi(2)).sum()
}

/// Seen from the sensor where it reports ranges; none of a direction.
fn place_m(detection: &Detection) -> Option<[f64; 3]> {
    let measurement = &detection.measurement;
    let place = measurement.position_seen_from(&Position::zeros())?;
    let up_m = match *measurement {
        Measurement::RangeBearingElevation {
            range_m,
            elevation_rad,
            ..
        } => range_m * elevation_rad.sin(),
        _ => measurement.z_m().unwrap_or(0.0),
    };
    Some([place.x, place.y, up_m])
}

fn mean(cluster: &[Detection]) -> Detection {
    let amplitudes = cluster.iter().filter_map(|one| one.amplitude);
    Detection {
        measurement: mean_measurement(cluster),
        origin: cluster.iter().find_map(|detection| detection.origin),
        amplitude: amplitudes.reduce(f64::max),
    }
}

/// All are of the kind of the first, for they are of one sensor.
fn mean_measurement(cluster: &[Detection]) -> Measurement {
    let each = |value: fn(&Measurement) -> f64| mean_of(cluster, value);
    let first = cluster[0].measurement;
    if cluster.len() == 1 {
        return first;
    }
    match first {
        Measurement::Position { .. } => Measurement::Position {
            x_m: each(|one| one.position().map_or(0.0, |at| at.x)),
            y_m: each(|one| one.position().map_or(0.0, |at| at.y)),
        },
        Measurement::Position3 { .. } => Measurement::Position3 {
            x_m: each(|one| one.position().map_or(0.0, |at| at.x)),
            y_m: each(|one| one.position().map_or(0.0, |at| at.y)),
            z_m: each(|one| one.z_m().unwrap_or(0.0)),
        },
        Measurement::RangeBearing { range_rate_mps, .. } => Measurement::RangeBearing {
            range_m: each(range_m),
            bearing_rad: mean_bearing_rad(cluster),
            range_rate_mps: range_rate_mps.map(|_| each(rate_mps)),
        },
        Measurement::RangeBearingElevation { range_rate_mps, .. } => {
            Measurement::RangeBearingElevation {
                range_m: each(range_m),
                bearing_rad: mean_bearing_rad(cluster),
                elevation_rad: each(|one| one.elevation_rad().unwrap_or(0.0)),
                range_rate_mps: range_rate_mps.map(|_| each(rate_mps)),
            }
        }
        direction => direction,
    }
}

fn mean_of(cluster: &[Detection], value: fn(&Measurement) -> f64) -> f64 {
    let sum: f64 = cluster.iter().map(|one| value(&one.measurement)).sum();
    sum / cluster.len() as f64
}

fn mean_bearing_rad(cluster: &[Detection]) -> f64 {
    let first_rad = bearing_rad(&cluster[0].measurement);
    let turns = cluster
        .iter()
        .map(|one| wrap(bearing_rad(&one.measurement) - first_rad));
    wrap(first_rad + turns.sum::<f64>() / cluster.len() as f64)
}

fn bearing_rad(measurement: &Measurement) -> f64 {
    match *measurement {
        Measurement::RangeBearing { bearing_rad, .. }
        | Measurement::RangeBearingElevation { bearing_rad, .. } => bearing_rad,
        _ => 0.0,
    }
}

fn range_m(measurement: &Measurement) -> f64 {
    match *measurement {
        Measurement::RangeBearing { range_m, .. }
        | Measurement::RangeBearingElevation { range_m, .. } => range_m,
        _ => 0.0,
    }
}

fn rate_mps(measurement: &Measurement) -> f64 {
    match *measurement {
        Measurement::RangeBearing { range_rate_mps, .. }
        | Measurement::RangeBearingElevation { range_rate_mps, .. } => {
            range_rate_mps.unwrap_or(0.0)
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(measurement: Measurement) -> Detection {
        Detection {
            measurement,
            origin: None,
            amplitude: None,
        }
    }

    fn place(x_m: f64, y_m: f64) -> Detection {
        at(Measurement::Position { x_m, y_m })
    }

    fn scan(detections: Vec<Detection>) -> Scan {
        Scan {
            number: 1,
            time_s: 0.0,
            sensor: 0,
            pose: None,
            detections,
            own: Vec::new(),
        }
    }

    /// 0, 4 and 8 m are a chain of links of 5 m, their mean is 4; 14 m is 6 m from the nearest; −3 m lies in another cell than 0.
    #[test]
    fn chains_become_one_detection_at_their_mean() {
        let mut scan = scan(vec![
            place(0.0, 1.0),
            place(14.0, 1.0),
            place(8.0, 2.0),
            place(4.0, 3.0),
        ]);
        assert_eq!(merge_scan(&mut scan, 5.0), [0, 1]);
        assert_eq!(scan.detections, [place(4.0, 2.0), place(14.0, 1.0)]);
        let mut across = self::scan(vec![place(-3.0, -1.0), place(0.0, -1.0)]);
        assert_eq!(merge_scan(&mut across, 5.0), [0]);
        assert_eq!(across.detections, [place(-1.5, -1.0)]);
    }

    /// North lies between 359° and 2°: their mean is 0.5°.
    #[test]
    fn bearings_are_averaged_around_north() {
        let seen = |range_m: f64, bearing_deg: f64| {
            at(Measurement::RangeBearing {
                range_m,
                bearing_rad: bearing_deg.to_radians(),
                range_rate_mps: Some(range_m / 10.0),
            })
        };
        let mut scan = scan(vec![seen(100.0, 359.0), seen(110.0, 2.0)]);
        assert_eq!(merge_scan(&mut scan, 15.0), [0]);
        let Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        } = scan.detections[0].measurement
        else {
            panic!("it is of a range and a bearing")
        };
        assert_eq!((range_m, range_rate_mps), (105.0, Some(10.5)));
        assert!(
            (bearing_rad.to_degrees() - 0.5).abs() < 1e-9,
            "{bearing_rad}"
        );
    }

    /// Linking by cells equals linking every pair, on 200 scans of 60 detections.
    #[test]
    fn cells_find_every_link() {
        let mut random = 7_u64;
        let mut draw = || {
            random = random
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (random >> 33) as f64 / 2f64.powi(31) * 100.0 - 50.0
        };
        for _ in 0..200 {
            let scan = scan((0..60).map(|_| place(draw(), draw())).collect());
            let mut parents = Vec::new();
            disjoint_sets::reset(&mut parents, 60);
            for (one, first) in scan.detections.iter().enumerate() {
                for (other, second) in scan.detections.iter().enumerate().take(one) {
                    let [a, b] = [first, second].map(|at| at.measurement.position().unwrap());
                    if (a - b).norm() <= 7.0 {
                        disjoint_sets::join(&mut parents, one as u32, other as u32);
                    }
                }
            }
            let pairs: Vec<u32> = (0..60)
                .map(|at| disjoint_sets::root(&mut parents, at))
                .collect();
            assert_eq!(roots(&scan, 7.0), pairs);
        }
    }
}
