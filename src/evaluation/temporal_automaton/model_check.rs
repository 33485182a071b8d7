//! The model check: (1) a detection is consumed by at most one track at a scan, (2) a track consumes at most one
//! detection at a scan. What a track consumes is its decision for (1), and every detection it gave a weight above zero
//! for (2); of those the most probable counted.

use crate::evaluation::strings::outputs::{Consumed, Outputs};
use serde::Serialize;
use std::collections::HashMap;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ViolationKind {
    DetectionSharedByTracks,
    SeveralDetectionsInTrack,
}

/// A broken condition at one scan (an index into the axis).
#[derive(Debug, Clone, PartialEq)]
pub struct Broken {
    pub scan: usize,
    pub kind: ViolationKind,
    pub detections: Vec<u32>,
    pub tracks: Vec<u32>,
}

/// Every violation, in order of scan.
pub fn check(outputs: &Outputs) -> Vec<Broken> {
    let mut broken = shared(&outputs.decisions);
    broken.extend(outputs.crowded.iter().map(|crowded| Broken {
        scan: crowded.scan,
        kind: ViolationKind::SeveralDetectionsInTrack,
        detections: crowded.detections.clone(),
        tracks: vec![crowded.track],
    }));
    broken.sort_by(|a, b| (a.scan, a.kind, &a.detections, &a.tracks).cmp(&(b.scan, b.kind, &b.detections, &b.tracks)));
    broken
}

/// A detection belongs to one scan, so its number alone tells takers of the same detection.
fn shared(decisions: &[Consumed]) -> Vec<Broken> {
    let numbers = decisions.iter().map(|decision| decision.detection as usize + 1).max().unwrap_or(0);
    let mut first_taker: Vec<Option<u32>> = vec![None; numbers];
    let mut broken: Vec<Broken> = Vec::new();
    let mut of_detection: HashMap<u32, usize> = HashMap::new();
    for &Consumed { track, scan, detection } in decisions {
        let Some(first) = first_taker[detection as usize] else {
            first_taker[detection as usize] = Some(track);
            continue;
        };
        let index = *of_detection.entry(detection).or_insert_with(|| {
            let kind = ViolationKind::DetectionSharedByTracks;
            broken.push(Broken { scan, kind, detections: vec![detection], tracks: vec![first] });
            broken.len() - 1
        });
        broken[index].tracks.push(track);
    }
    broken
}
