//! The model check: (1) a detection is consumed by at most one track at a scan, (2) a track consumes at most one
//! detection at a scan. What a track consumes is what it decided on. Weights that share one scan between detections are a
//! doubt and no violation; a track that claims several detections with more than one in all breaks (2), and the most
//! probable counted. Where every choice is kept (`all_gated`), (2) is not asked for.

use crate::evaluation::strings::outputs::{Consumed, Outputs};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ViolationKind {
    DetectionSharedByTracks,
    SeveralDetectionsInTrack,
}

/// A broken condition at one scan (an index into the axis).
#[derive(Debug, Clone, PartialEq)]
pub struct Broken {
    pub scan: u32,
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
    broken.sort_by(|a, b| {
        (a.scan, a.kind, &a.detections, &a.tracks).cmp(&(b.scan, b.kind, &b.detections, &b.tracks))
    });
    broken
}

/// A detection belongs to one scan, so its number alone tells takers of the same detection.
fn shared(decisions: &[Consumed]) -> Vec<Broken> {
    const NOBODY: u32 = u32::MAX;
    let numbers = decisions
        .iter()
        .map(|decision| decision.detection as usize + 1)
        .max()
        .unwrap_or(0);
    let mut first_taker = vec![NOBODY; numbers];
    let mut broken: BTreeMap<u32, Broken> = BTreeMap::new();
    for &Consumed {
        track,
        scan,
        detection,
    } in decisions
    {
        let first = &mut first_taker[detection as usize];
        if *first == NOBODY {
            *first = track;
            continue;
        }
        let kind = ViolationKind::DetectionSharedByTracks;
        let of_detection = broken.entry(detection);
        of_detection
            .or_insert_with(|| Broken {
                scan,
                kind,
                detections: vec![detection],
                tracks: vec![*first],
            })
            .tracks
            .push(track);
    }
    broken.into_values().collect()
}
