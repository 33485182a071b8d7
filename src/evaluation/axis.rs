//! The scan axis: the scans on which strings are written, in order, and the place of each.
//!
//! With a recording the axis is its scans; each (time, sensor) is one scan. Scan numbers may have holes
//! ([`crate::model::scan_numbers`]): the scans in a hole exist and are empty, so they only take up places, evenly between the
//! scans around them. A hole never takes more places than end a string, so a wild scan number costs nothing. Without a recording the axis is the steps at which metrics compare
//! truth and tracks, so that a track which begins late or ends early lacks symbols.

use super::steps::Steps;
use crate::model::scan::Recording;
use crate::model::scan_numbers;
use crate::model::track::{TrackPoint, TrackSet};
use std::collections::HashMap;
use std::ops::Range;

/// One scan of the axis. `position` is its place, counting the empty scans of holes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisScan {
    pub number: u32,
    pub time_s: f64,
    pub position: usize,
    /// `None` where scans are told apart by time alone, and of a step that fills a hole.
    sensor: Option<usize>,
}

/// The place of a scan that no recording has.
const NOT_RECORDED: u32 = u32::MAX;

#[derive(Debug)]
pub struct Axis {
    scans: Vec<AxisScan>,
    /// For each sensor that track points name: its index in the recording, if the recording has it.
    sensor_of_point: Vec<Option<usize>>,
    /// What times belong to which scan.
    steps: Steps,
    by_time_alone: bool,
    /// Of each scan its place in the recording, where that is another one.
    recorded: Vec<u32>,
}

impl Axis {
    /// `steps` are the times of the recording.
    pub fn of_recording(
        recording: &Recording,
        tracks: &TrackSet,
        steps: Steps,
        max_missed: u32,
    ) -> Self {
        let indices: HashMap<&str, usize> = recording
            .sensors
            .iter()
            .enumerate()
            .map(|(index, sensor)| (sensor.sensor_id.as_str(), index))
            .collect();
        let empty = empty_scans(recording, max_missed);
        let mut passed = 0;
        let mut scans: Vec<AxisScan> = Vec::with_capacity(recording.scans.len());
        for (index, scan) in recording.scans.iter().enumerate() {
            while empty
                .get(passed)
                .is_some_and(|&(time_s, sensor)| (time_s, sensor) <= (scan.time_s, scan.sensor))
            {
                passed += 1;
            }
            scans.push(AxisScan {
                number: scan.number,
                time_s: scan.time_s,
                position: index + passed,
                sensor: Some(scan.sensor),
            });
        }
        let sensor_of_point = tracks
            .sensor_ids
            .iter()
            .map(|name| indices.get(name.as_str()).copied())
            .collect();
        Axis {
            scans,
            sensor_of_point,
            steps,
            by_time_alone: false,
            recorded: Vec::new(),
        }
    }

    /// The same with the steps that fill holes of the recording; a hole that is filled takes no places besides.
    pub fn of_filled(
        recording: &Recording,
        tracks: &TrackSet,
        steps: Steps,
        max_missed: u32,
    ) -> Self {
        let filled = steps.filled;
        let mut axis = Axis::of_recording(recording, tracks, steps, max_missed);
        if filled == 0 {
            return axis;
        }
        let is_recorded = |time_s: &f64| {
            let place = recording
                .scans
                .partition_point(|scan| scan.time_s < *time_s);
            recording
                .scans
                .get(place)
                .is_some_and(|scan| scan.time_s == *time_s)
        };
        let mut holes = axis
            .steps
            .times_s()
            .filter(|time_s| !is_recorded(time_s))
            .peekable();
        let (mut scans, mut recorded) = (Vec::new(), Vec::new());
        let (mut position, mut before) = (0, None::<AxisScan>);
        for (index, scan) in axis.scans.iter().enumerate() {
            let is_first_filled = holes.peek().is_some_and(|time_s| *time_s < scan.time_s);
            while let Some(time_s) = holes.next_if(|time_s| *time_s < scan.time_s) {
                let number = before.map_or(scan.number, |before| before.number);
                scans.push(AxisScan {
                    number,
                    time_s,
                    position,
                    sensor: None,
                });
                recorded.push(NOT_RECORDED);
                position += 1;
            }
            if !is_first_filled && let Some(before) = before {
                position += scan.position - before.position - 1;
            }
            scans.push(AxisScan { position, ..*scan });
            recorded.push(index as u32);
            position += 1;
            before = Some(*scan);
        }
        drop(holes);
        (axis.scans, axis.recorded) = (scans, recorded);
        axis
    }

    pub fn of_steps(steps: Steps) -> Self {
        let scan = |(position, time_s)| AxisScan {
            number: position as u32 + 1,
            time_s,
            position,
            sensor: None,
        };
        let scans = steps.times_s().enumerate().map(scan).collect();
        Axis {
            scans,
            sensor_of_point: Vec::new(),
            steps,
            by_time_alone: true,
            recorded: Vec::new(),
        }
    }

    /// The place of a scan among those of the recording; `None` of a step that fills a hole.
    pub fn recorded(&self, scan: usize) -> Option<usize> {
        let place = self.recorded.get(scan).map_or(scan as u32, |place| *place);
        (place != NOT_RECORDED).then_some(place as usize)
    }

    /// The times that belong to a scan.
    pub fn window_s(&self, scan: usize) -> (f64, f64) {
        let time_s = self.scans[scan].time_s;
        self.steps
            .at(time_s)
            .map_or((time_s, time_s), |step| self.steps.window_s(step))
    }

    /// What its places are: scans of a recording, or steps.
    pub fn place_name(&self) -> &'static str {
        if self.by_time_alone { "step" } else { "scan" }
    }

    /// Times nearer than this belong to one scan.
    pub fn tolerance_s(&self) -> f64 {
        self.steps.tolerance_s
    }

    pub fn scans(&self) -> &[AxisScan] {
        &self.scans
    }

    /// The scan at a place of the axis that is not in a hole.
    pub fn at_position(&self, position: usize) -> &AxisScan {
        &self.scans[self.scans.partition_point(|scan| scan.position < position)]
    }

    /// The scan at a place of the axis; `None` in a hole.
    pub fn scan_at(&self, position: usize) -> Option<&AxisScan> {
        self.scans
            .get(self.scans.partition_point(|scan| scan.position < position))
            .filter(|scan| scan.position == position)
    }

    /// The same as [`scan_of`](Self::scan_of), quickest where `guess` is the answer.
    #[inline]
    pub fn scan_near(&self, point: &TrackPoint, guess: usize) -> Option<usize> {
        let is_at = |index: usize| {
            self.scans
                .get(index)
                .is_some_and(|scan| scan.time_s == point.time_s)
        };
        let is_right = is_at(guess)
            && match point.sensor {
                Some(sensor) if !self.by_time_alone => {
                    let wanted = self.sensor_of_point[sensor as usize];
                    wanted.is_some() && self.scans[guess].sensor == wanted
                }
                _ => !is_at(guess + 1) && (guess == 0 || !is_at(guess - 1)),
            };
        if is_right {
            Some(guess)
        } else {
            self.scan_of(point)
        }
    }

    /// Index of the scan that a track point belongs to: the same time, within the tolerance, and the same sensor. A point
    /// without a sensor belongs to the only scan at its time, and to none when there are several.
    pub fn scan_of(&self, point: &TrackPoint) -> Option<usize> {
        let step = self.steps.at(point.time_s)?;
        if self.by_time_alone {
            return Some(step);
        }
        let mut at_time = self.scans_of_step(step);
        match point.sensor {
            Some(sensor) => {
                let wanted = self.sensor_of_point[sensor as usize]?;
                let is_fit = |scan: &usize| {
                    self.scans[*scan]
                        .sensor
                        .is_none_or(|sensor| sensor == wanted)
                };
                at_time.find(is_fit)
            }
            None => (at_time.len() == 1).then_some(at_time.start),
        }
    }

    /// Indices of the scans of all sensors that a time belongs to.
    pub fn scans_at(&self, time_s: f64) -> Range<usize> {
        self.steps.at(time_s).map_or(0..0, |step| {
            if self.by_time_alone {
                step..step + 1
            } else {
                self.scans_of_step(step)
            }
        })
    }

    fn scans_of_step(&self, step: usize) -> Range<usize> {
        let time_s = self.steps.time_s(step);
        let first = self.scans.partition_point(|scan| scan.time_s < time_s);
        first..first + self.scans[first..].partition_point(|scan| scan.time_s == time_s)
    }
}

/// Times and sensors of the scans in holes, in order: at most `max_missed` in each hole.
fn empty_scans(recording: &Recording, max_missed: u32) -> Vec<(f64, usize)> {
    let mut empty = Vec::new();
    for gap in scan_numbers::gaps(recording) {
        let (before, after) = (&recording.scans[gap.before], &recording.scans[gap.after]);
        let count = gap.missing.min(max_missed);
        let time_s = |place: u32| {
            before.time_s + (after.time_s - before.time_s) * f64::from(place) / f64::from(count + 1)
        };
        empty.extend((1..=count).map(|place| (time_s(place).min(after.time_s), after.sensor)));
    }
    empty.sort_unstable_by(|left, right| left.0.total_cmp(&right.0).then(left.1.cmp(&right.1)));
    empty
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan::{RecordingParts, Scan};
    use crate::model::sensor::SensorSettings;
    use crate::model::state::State;
    use crate::model::track::Kinematics;

    fn recording(sensors: &[&str], scans: &[(u32, f64, usize)]) -> Recording {
        let scan = |&(number, time_s, sensor): &(u32, f64, usize)| Scan {
            number,
            time_s,
            sensor,
            pose: None,
            own: Vec::new(),
            detections: Vec::new(),
        };
        Recording::new(RecordingParts {
            sensors: sensors
                .iter()
                .map(|name| SensorSettings::named(*name))
                .collect(),
            scans: scans.iter().map(scan).collect(),
            ..Default::default()
        })
        .unwrap()
    }

    fn steps(recording: &Recording) -> Steps {
        Steps::of_detections(recording, &TrackSet::default(), None)
    }

    fn point(time_s: f64, sensor: Option<u32>) -> TrackPoint {
        let estimate = Kinematics::of_plane(&State::zeros(), false, None);
        TrackPoint {
            height_m: None,
            time_s,
            sensor,
            estimate,
            status: None,
            nis: None,
            known_at_s: None,
            existence: None,
            mode_row: None,
            first_candidate: 0,
            candidates: 0,
        }
    }

    #[test]
    fn holes_in_the_numbers_take_up_places_but_never_more_than_end_a_string() {
        let recording = recording(
            &["radar"],
            &[
                (1, 0.0, 0),
                (2, 1.0, 0),
                (5, 4.0, 0),
                (4_000_000_000, 5.0, 0),
                (3, 6.0, 0),
            ],
        );
        let axis = Axis::of_recording(&recording, &TrackSet::default(), steps(&recording), 5);
        let positions: Vec<usize> = axis.scans().iter().map(|scan| scan.position).collect();
        assert_eq!(positions, [0, 1, 4, 10, 11]);
        assert_eq!(axis.at_position(10).number, 4_000_000_000);
        assert_eq!(
            axis.scan_at(10).map(|scan| scan.number),
            Some(4_000_000_000)
        );
        assert_eq!((axis.scan_at(3), axis.scan_at(12)), (None, None));
    }

    #[test]
    fn a_scan_that_two_sensors_leave_out_takes_a_place_for_each() {
        // Scan 3 of both, at 2 s, as if it were written.
        let scans = [
            (1, 0.0, 0),
            (1, 0.0, 1),
            (2, 1.0, 0),
            (2, 1.0, 1),
            (4, 3.0, 0),
            (4, 3.0, 1),
        ];
        let recording = recording(&["radar", "lidar"], &scans);
        let axis = Axis::of_recording(&recording, &TrackSet::default(), steps(&recording), 5);
        assert_eq!(
            axis.scans()
                .iter()
                .map(|scan| scan.position)
                .collect::<Vec<_>>(),
            [0, 1, 2, 3, 6, 7]
        );
        assert_eq!((axis.scans_at(3.0), axis.scans_at(2.0)), (4..6, 0..0));
    }

    #[test]
    fn points_find_their_scan_by_time_and_sensor() {
        let recording = recording(
            &["radar", "lidar"],
            &[(1, 0.0, 0), (2, 0.0, 1), (3, 1.0, 1)],
        );
        let tracks = TrackSet {
            sensor_ids: vec!["lidar".into(), "sonar".into()],
            ..Default::default()
        };
        let axis = Axis::of_recording(&recording, &tracks, steps(&recording), 5);
        assert_eq!(axis.scan_of(&point(0.0, Some(0))), Some(1));
        assert_eq!(
            axis.scan_of(&point(1.0, None)),
            Some(2),
            "only one scan at that time"
        );
        assert_eq!(
            axis.scan_of(&point(0.0, None)),
            None,
            "two scans at that time"
        );
        assert_eq!(axis.scan_of(&point(0.0, Some(1))), None, "no such sensor");
        assert_eq!(axis.scan_of(&point(0.5, None)), None, "no such time");
        assert_eq!(axis.scan_of(&point(f64::NAN, None)), None);
        for (time_s, sensor) in [
            (0.0, Some(0)),
            (1.0, None),
            (0.0, None),
            (0.0, Some(1)),
            (0.5, None),
            (f64::NAN, None),
            (1.0, Some(0)),
        ] {
            let point = point(time_s, sensor);
            assert!(
                (0..5).all(|guess| axis.scan_near(&point, guess) == axis.scan_of(&point)),
                "{time_s} {sensor:?}"
            );
        }
    }
}
