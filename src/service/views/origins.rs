//! Which target each detection that a track took came from.

use super::layers::JobLayers;
use crate::model::track::{Candidate, TrackPoint, TrackSet};
use std::collections::{HashMap, HashSet};

/// A detection of the recording under its name.
struct Reported<'a> {
    time_s: f64,
    sensor_id: &'a str,
    origin: Option<u32>,
}

/// The targets behind the detections that tracks took.
pub(super) struct Origins<'a> {
    set: &'a TrackSet,
    targets: &'a [String],
    /// By name: a name is unique within its scan alone.
    reported: HashMap<&'a str, Vec<Reported<'a>>>,
}

impl<'a> Origins<'a> {
    /// Of the detections that some track named; `None` where the recording does not say where detections came from.
    pub fn of(layers: &'a JobLayers, set: &'a TrackSet) -> Option<Origins<'a>> {
        let recording = layers.detections.as_ref()?;
        if !recording.origins_known {
            return None;
        }
        let wanted: HashSet<&str> = set.detection_ids.iter().map(String::as_str).collect();
        let mut reported: HashMap<&str, Vec<Reported>> = HashMap::with_capacity(wanted.len());
        for (first, scan) in recording.scans_with_firsts() {
            let sensor_id = recording.sensors[scan.sensor].sensor_id.as_str();
            for (detection_id, detection) in recording.detection_ids[first..]
                .iter()
                .zip(&scan.detections)
                .filter(|(detection_id, _)| wanted.contains(detection_id.as_str()))
            {
                let report = Reported {
                    time_s: scan.time_s,
                    sensor_id,
                    origin: detection.origin,
                };
                reported.entry(detection_id).or_default().push(report);
            }
        }
        Some(Origins {
            set,
            targets: &recording.targets,
            reported,
        })
    }

    /// The target that a candidate came from; `None` for ε and clutter.
    pub fn target(&self, point: &TrackPoint, candidate: &Candidate) -> Option<u32> {
        let detection_id = &self.set.detection_ids[candidate.detection? as usize];
        let reports = self.reported.get(detection_id.as_str())?;
        let sensor_id = point
            .sensor
            .map(|index| self.set.sensor_ids[index as usize].as_str());
        let of_scan = reports.iter().find(|report| {
            report.time_s == point.time_s && sensor_id.is_none_or(|id| id == report.sensor_id)
        });
        // A name that stands once in the recording needs no time.
        let alone = || reports.first().filter(|_| reports.len() == 1);
        of_scan.or_else(alone)?.origin
    }

    pub fn name(&self, target: u32) -> &'a str {
        &self.targets[target as usize]
    }
}
