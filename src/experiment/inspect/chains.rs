//! Detections followed from scan to scan without a tracker: each to the one that is nearest, where that is so both ways.

use super::places_of_scan;
use crate::model::scan::Recording;
use crate::model::space::Place;
use crate::model::state::Position;

/// Scans of a sensor, and detections of a scan, that are looked at; more tell no more.
const MOST_SCANS: usize = 300;
const MOST_DETECTIONS: usize = 100;

/// Places of what may be one object, in order of time: (s, m).
pub type Chain = Vec<(f64, Place)>;

/// The chains of all sensors.
pub fn of(recording: &Recording) -> Vec<Chain> {
    let mut chains: Vec<Chain> = Vec::new();
    for sensor in 0..recording.sensors.len() {
        // Of the scan before: its places, and the chain that ends in each.
        let (mut before_m, mut ends): (Vec<Position>, Vec<usize>) = (Vec::new(), Vec::new());
        let of_it = recording.scans.iter().filter(|scan| scan.sensor == sensor);
        for scan in of_it.take(MOST_SCANS) {
            let places_m: Vec<Position> = places_of_scan(recording, scan)
                .take(MOST_DETECTIONS)
                .collect();
            if places_m.is_empty() {
                continue;
            }
            let (forth, back) = (nearest(&before_m, &places_m), nearest(&places_m, &before_m));
            let mut next = Vec::with_capacity(places_m.len());
            for (at, place_m) in places_m.iter().enumerate() {
                let end = back[at].filter(|&end| forth[end] == Some(at));
                let chain = end.map_or(chains.len(), |end| ends[end]);
                if chain == chains.len() {
                    chains.push(Chain::new());
                }
                chains[chain].push((scan.time_s, place_m.push(0.0)));
                next.push(chain);
            }
            (before_m, ends) = (places_m, next);
        }
    }
    chains
}

/// For each of the first the nearest of the second.
fn nearest(of: &[Position], among: &[Position]) -> Vec<Option<usize>> {
    of.iter().map(|from| nearest_of(from, among)).collect()
}

fn nearest_of(from: &Position, among: &[Position]) -> Option<usize> {
    let way_m = |to: usize| (among[to] - from).norm_squared();
    (0..among.len()).min_by(|&a, &b| way_m(a).total_cmp(&way_m(b)))
}
