//! Joins the detections that tracks name with the detections of a recording, scan by scan.
//!
//! An identity is a name within a scan. A detection of the recording is known by its index; a name that the scan does
//! not have gets a number of its own behind them, the same for the same name in the same scan.

use crate::model::scan::{DetectionIndex, Recording};
use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::Range;

pub struct Identities<'a> {
    recording: Option<&'a Recording>,
    detections: Option<DetectionIndex<'a>>,
    names: &'a [String],
    /// The tracks use the recording's own list of names, so that an index in the right scan is the identity itself.
    same_names: bool,
    /// Detections in scan order, those of one scan by name. Made when first needed.
    by_name: OnceCell<Vec<u32>>,
    others: HashMap<(usize, &'a str), u32>,
    other_names: Vec<&'a str>,
}

impl<'a> Identities<'a> {
    /// `names` are those that the tracks' candidates refer to.
    pub fn new(recording: Option<&'a Recording>, names: &'a [String]) -> Self {
        let same_names = recording.is_some_and(|recording| recording.detection_ids == names);
        Identities {
            recording,
            detections: recording.map(|recording| recording.index_detections()),
            names,
            same_names,
            by_name: OnceCell::new(),
            others: HashMap::new(),
            other_names: Vec::new(),
        }
    }

    /// The identity of the `index`-th name in a scan.
    #[inline]
    pub fn resolve(&mut self, scan: usize, index: u32) -> u32 {
        if self.same_names && self.range(scan).contains(&(index as usize)) {
            return index;
        }
        let name = self.names[index as usize].as_str();
        if let Some(known) = self
            .recording
            .and_then(|recording| self.find(recording, scan, name))
        {
            return known;
        }
        let next = (self.known() + self.other_names.len()) as u32;
        *self.others.entry((scan, name)).or_insert_with(|| {
            self.other_names.push(name);
            next
        })
    }

    /// Whether a scan of the recording has a detection of the `index`-th name.
    pub fn is_in(&self, scan: usize, index: u32) -> bool {
        let Some(recording) = self.recording else {
            return false;
        };
        let is_at_its_place = self.same_names && self.range(scan).contains(&(index as usize));
        is_at_its_place
            || self
                .find(recording, scan, &self.names[index as usize])
                .is_some()
    }

    /// Whether there is a recording and it does not have this identity.
    pub fn is_unknown(&self, identity: u32) -> bool {
        self.recording.is_some() && identity as usize >= self.known()
    }

    /// How many identities are detections of the recording: all below this number.
    fn known(&self) -> usize {
        self.recording.map_or(0, Recording::detection_count)
    }

    pub fn name(&self, identity: u32) -> &str {
        match self.recording {
            Some(recording) if (identity as usize) < self.known() => {
                &recording.detection_ids[identity as usize]
            }
            _ => self.other_names[identity as usize - self.known()],
        }
    }

    /// The target that a detection came from; `None` for clutter and for names the recording does not have.
    pub fn origin(&self, identity: u32) -> Option<u32> {
        self.detections.as_ref()?.get(identity as usize)?.origin
    }

    /// The detections of a scan of the recording; none without one.
    #[inline]
    fn range(&self, scan: usize) -> Range<usize> {
        self.detections
            .as_ref()
            .map_or(0..0, |detections| detections.range(scan))
    }

    fn find(&self, recording: &Recording, scan: usize, name: &str) -> Option<u32> {
        let of_scan = &self.by_name.get_or_init(|| sorted_by_name(recording))[self.range(scan)];
        let place = of_scan.binary_search_by(|&detection| {
            recording.detection_ids[detection as usize]
                .as_str()
                .cmp(name)
        });
        place.ok().map(|place| of_scan[place])
    }
}

fn sorted_by_name(recording: &Recording) -> Vec<u32> {
    let mut order: Vec<u32> = (0..recording.detection_count() as u32).collect();
    for (first, scan) in recording.scans_with_firsts() {
        order[first..first + scan.detections.len()].sort_unstable_by(|&a, &b| {
            recording.detection_ids[a as usize].cmp(&recording.detection_ids[b as usize])
        });
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan::{Detection, Measurement, RecordingParts, Scan};
    use crate::model::sensor::SensorSettings;

    fn recording() -> Recording {
        let detection = Detection {
            measurement: Measurement::Position { x_m: 0.0, y_m: 0.0 },
            origin: None,
            amplitude: None,
        };
        let scan = |number: u32| Scan {
            number,
            time_s: f64::from(number),
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections: vec![detection; 2],
        };
        Recording::new(RecordingParts {
            sensors: vec![SensorSettings::named("radar")],
            scans: vec![scan(1), scan(2)],
            detection_ids: ["b", "a", "a", "b"].map(String::from).to_vec(),
            ..Default::default()
        })
        .unwrap()
    }

    #[test]
    fn names_are_looked_up_within_the_scan() {
        let recording = recording();
        let names = ["a", "b", "z"].map(String::from);
        let mut identities = Identities::new(Some(&recording), &names);
        assert_eq!([0, 1].map(|scan| identities.resolve(scan, 0)), [1, 2]);
        assert_eq!([0, 1].map(|scan| identities.resolve(scan, 1)), [0, 3]);
        assert_eq!(
            [0, 1, 0].map(|scan| identities.resolve(scan, 2)),
            [4, 5, 4],
            "unknown names, one a scan"
        );
        assert_eq!(identities.name(5), "z");
    }

    #[test]
    fn the_recordings_own_list_gives_the_index_or_else_the_name() {
        let recording = recording();
        let mut identities = Identities::new(Some(&recording), &recording.detection_ids);
        assert_eq!(identities.resolve(1, 3), 3);
        assert_eq!(
            identities.resolve(1, 0),
            3,
            "index 0 is of scan 0, but its name 'b' is in scan 1 too"
        );
    }
}
