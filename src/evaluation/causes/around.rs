//! What is around the places of a step: the detections of its scans, and tracks that were not known then.

use crate::evaluation::EvaluationInput;
use crate::evaluation::comparison::Comparison;
use crate::evaluation::credit::Credit;
use crate::evaluation::spaces;
use crate::model::scan::{Recording, Scan};
use crate::model::sensor::SensorSettings;
use crate::model::sight::{Limits, Spot};
use crate::model::space::Place;
use crate::model::state::Position;
use std::ops::Range;

/// Somebody at a place: a detection without a height is at any.
#[derive(Debug, Clone, Copy)]
struct Stander {
    place_m: Place,
    has_height: bool,
    /// A detection of the scan, or a track.
    who: u32,
}

/// Places by their first axis, so that few are looked at.
#[derive(Debug, Default)]
struct Crowd(Vec<Stander>);

impl Crowd {
    fn sort(&mut self) {
        self.0.sort_by(|a, b| a.place_m.x.total_cmp(&b.place_m.x));
    }

    /// The nearest within the gate.
    fn nearest(&self, place_m: &Place, gate_m: f64) -> Option<u32> {
        let first = self
            .0
            .partition_point(|one| one.place_m.x < place_m.x - gate_m);
        let mut nearest = (f64::INFINITY, None);
        for one in &self.0[first..] {
            if one.place_m.x > place_m.x + gate_m {
                break;
            }
            let mut offset_m = one.place_m - place_m;
            if !one.has_height {
                offset_m.z = 0.0;
            }
            let distance_m = offset_m.norm();
            if distance_m <= gate_m && distance_m < nearest.0 {
                nearest = (distance_m, Some(one.who));
            }
        }
        nearest.1
    }
}

/// Of each step in turn.
pub struct Around<'a> {
    comparison: &'a Comparison,
    recording: Option<&'a Recording>,
    views: Vec<Option<Limits>>,
    /// The steps at which something may be due, with the time up to which each is the nearest.
    due: Vec<(u32, f64)>,
    /// The scans of each step.
    scans: Vec<Range<usize>>,
    detections: Crowd,
    /// Points that are not credited: step, track, place; by step.
    unknown: Vec<(u32, u32, Place)>,
    next_unknown: usize,
    tentative: Crowd,
    step: usize,
}

impl<'a> Around<'a> {
    pub fn new(
        comparison: &'a Comparison,
        input: Option<&EvaluationInput<'a>>,
        credit: Credit,
    ) -> Self {
        let input = input.filter(|_| comparison.is_in_metres());
        let recording = input.and_then(|input| input.recording);
        let recording = recording.filter(|recording| recording.detection_count() > 0);
        let due = ends_of_steps(comparison);
        let steps = comparison.steps.len();
        let scans = recording.map(|recording| scans_of_steps(recording, &due, steps));
        let sensors = recording.map_or(&[][..], |recording| &recording.sensors);
        let mut around = Around {
            comparison,
            recording,
            views: sensors.iter().map(SensorSettings::limits).collect(),
            scans: scans.unwrap_or_default(),
            detections: Crowd::default(),
            due,
            unknown: Vec::new(),
            next_unknown: 0,
            tentative: Crowd::default(),
            step: 0,
        };
        if let Some(input) = input {
            around.take_uncredited(input, credit);
        }
        around
    }

    /// The points of tracks that are not credited, by their nearest steps.
    fn take_uncredited(&mut self, input: &EvaluationInput, credit: Credit) {
        let space = self.comparison.space.unwrap_or_default();
        for (track, of_track) in (0..).zip(&input.tracks.tracks) {
            for point in &of_track.points {
                if credit.counts(point) {
                    continue;
                }
                if let Some(step) = self.step_at(point.time_s) {
                    let place_m = spaces::compared(space, &point.estimate.position);
                    self.unknown.push((step as u32, track, place_m));
                }
            }
        }
        self.unknown.sort_by_key(|(step, track, _)| (*step, *track));
    }

    /// Whether there are detections.
    pub fn has_scans(&self) -> bool {
        self.recording.is_some()
    }

    pub fn scans_of(&self, step: usize) -> &'a [Scan] {
        let range = self.scans.get(step).cloned().unwrap_or_default();
        self.recording
            .map_or(&[], |recording| &recording.scans[range])
    }

    /// Whether the step has any.
    pub fn has_scans_now(&self) -> bool {
        !self.scans_of(self.step).is_empty()
    }

    /// The step that a time is nearest to.
    pub fn step_at(&self, time_s: f64) -> Option<usize> {
        let place = self.due.partition_point(|(_, end_s)| *end_s < time_s);
        self.due.get(place).map(|(step, _)| *step as usize)
    }

    /// The place of a step's first scan in the recording.
    pub fn first_scan_of(&self, step: usize) -> usize {
        self.scans.get(step).map_or(0, |range| range.start)
    }

    /// Goes to a step, each later than the one before.
    pub fn enter(&mut self, step: usize) {
        self.step = step;
        self.detections.0.clear();
        for scan in self.scans_of(step) {
            let sensor_m = self.sensor_place_m(scan);
            for (index, one) in scan.detections.iter().enumerate() {
                let Some(seen_m) = one.measurement.position_seen_from(&sensor_m) else {
                    continue;
                };
                let z_m = one.measurement.z_m();
                let space = self.comparison.space.unwrap_or_default();
                self.detections.0.push(Stander {
                    place_m: space.cut(seen_m.push(z_m.unwrap_or_default())),
                    has_height: z_m.is_some(),
                    who: index as u32,
                });
            }
        }
        self.detections.sort();
        self.tentative.0.clear();
        while let Some(&(at, track, place_m)) = self.unknown.get(self.next_unknown) {
            if at as usize > step {
                break;
            }
            self.next_unknown += 1;
            if at as usize == step {
                self.tentative.0.push(Stander {
                    place_m,
                    has_height: true,
                    who: track,
                });
            }
        }
        self.tentative.sort();
    }

    /// Whether some scan of the step has a detection within the gate.
    pub fn sees(&self, place_m: &Place) -> bool {
        let gate_m = self.comparison.gate;
        self.detections.nearest(place_m, gate_m).is_some()
    }

    /// A track within the gate that was not known at the time.
    pub fn tentative_at(&self, place_m: &Place) -> Option<u32> {
        self.tentative.nearest(place_m, self.comparison.gate)
    }

    /// Whether a sensor of the step's scans could see the place; one that does not say where it looks could.
    pub fn covers(&self, place_m: &Place) -> bool {
        self.scans_of(self.step).iter().any(|scan| {
            let view = self.views.get(scan.sensor).and_then(Option::as_ref);
            let spot = Spot::of_place(&place_m.xy(), &self.sensor_place_m(scan));
            view.is_none_or(|view| view.hold(&spot))
        })
    }

    /// Where a detection of a scan is.
    pub fn place_of(&self, scan: &Scan, detection: usize) -> Option<Position> {
        let measurement = &scan.detections[detection].measurement;
        measurement.position_seen_from(&self.sensor_place_m(scan))
    }

    fn sensor_place_m(&self, scan: &Scan) -> Position {
        let sensor = self
            .recording
            .and_then(|recording| recording.sensors.get(scan.sensor));
        let place_m = sensor.map_or_else(Position::zeros, |sensor| {
            Position::new(
                sensor.x_m.unwrap_or_default(),
                sensor.y_m.unwrap_or_default(),
            )
        });
        scan.sensor_place_m(place_m)
    }
}

/// Steps with the time up to which each is the nearest; those at which nothing is due take nothing from others.
fn ends_of_steps(comparison: &Comparison) -> Vec<(u32, f64)> {
    let steps = (0..).zip(&comparison.steps);
    let due = steps.filter(|(_, step)| !step.is_extra);
    let mut ends: Vec<(u32, f64)> = due.map(|(index, step)| (index, step.time_s)).collect();
    let mut after_s = f64::INFINITY;
    for (_, end_s) in ends.iter_mut().rev() {
        let time_s = std::mem::replace(end_s, 0.5 * (*end_s + after_s));
        after_s = time_s;
    }
    ends
}

/// The scans of each of so many steps.
fn scans_of_steps(recording: &Recording, due: &[(u32, f64)], steps: usize) -> Vec<Range<usize>> {
    let mut ranges = vec![0..0; steps];
    let mut next = 0;
    for (step, end_s) in due {
        let first = next;
        while recording
            .scans
            .get(next)
            .is_some_and(|scan| scan.time_s <= *end_s)
        {
            next += 1;
        }
        ranges[*step as usize] = first..next;
    }
    ranges
}
