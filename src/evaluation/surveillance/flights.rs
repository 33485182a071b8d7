//! The updates of each target, and what of them is judged in a sector and a phase.

use super::gaps::{Period, periods};
use super::pairing::{Paired, Pairs};
use super::reference::{Doing, Phase, Reference, doings, height_at, reference_at};
use super::settings::Sector;
use crate::model::space::{Place, Space};
use crate::model::track::{TrackPoint, TrackSet};
use crate::model::truth::TruthSet;

/// A point of a track that is of a target.
#[derive(Debug, Clone)]
pub struct Update {
    pub time_s: f64,
    /// Index into the tracks of the set.
    pub track: u32,
    /// Index into its sensors, where it says.
    pub sensor: Option<u32>,
    pub place: Place,
    pub height_m: Option<f64>,
    pub velocity: Option<Place>,
    pub reference: Option<Reference>,
}

/// One target with its updates in the order of time.
pub struct Flight {
    pub target: usize,
    pub updates: Vec<Update>,
    /// At each point of the truth.
    doings: Vec<Doing>,
}

/// What of a flight is judged: each update's place is as good as its reference's.
pub struct View<'a> {
    pub flight: &'a Flight,
    pub periods: Vec<Period>,
    /// Of each update, whether its reference is in the sector and the phase.
    pub inside: Vec<bool>,
    /// Of each update, whether it is itself in the sector.
    pub is_seen_inside: Vec<bool>,
}

/// All flights, in the order of the targets.
pub fn flights(truth: &TruthSet, tracks: &TrackSet, pairs: &Pairs, reach_s: f64) -> Vec<Flight> {
    let of_target = |(target, truth_target)| Flight {
        target,
        updates: Vec::new(),
        doings: doings(truth.space(), truth_target),
    };
    let targets = truth.targets().iter().enumerate();
    let mut flights: Vec<Flight> = targets.map(of_target).collect();
    for (number, track) in tracks.tracks.iter().enumerate() {
        for (point, paired) in track.points.iter().zip(&pairs.of[number]) {
            let Paired::Target(target) = *paired else {
                continue;
            };
            let target = target as usize;
            let place = point.estimate.position;
            flights[target].updates.push(Update {
                time_s: point.time_s,
                track: number as u32,
                sensor: point.sensor,
                place,
                height_m: height_of(tracks.space, point),
                velocity: point.estimate.velocity,
                reference: reference_at(truth, target, point.time_s, reach_s),
            });
        }
    }
    for flight in &mut flights {
        flight
            .updates
            .sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.track.cmp(&b.track)));
    }
    flights
}

/// How high a point of a track is, where that is known.
pub fn height_of(space: Space, point: &TrackPoint) -> Option<f64> {
    let is_high = space == Space::Volume;
    is_high
        .then_some(point.estimate.position.z)
        .or(point.height_m)
}

impl Flight {
    pub fn view(
        &self,
        truth: &TruthSet,
        (sector, phase): (&Sector, Option<Phase>),
        reach_s: f64,
    ) -> View<'_> {
        let target = &truth.targets()[self.target];
        let is_phase = |point: usize| phase.is_none_or(|phase| phase.holds(self.doings[point]));
        let mut points = Vec::with_capacity(target.points.len());
        for (number, point) in target.points.iter().enumerate() {
            let height_m = height_at(truth.space(), target, number);
            let is_inside = sector.holds(&point.position, height_m) && is_phase(number);
            points.push((point.time_s, is_inside));
        }
        let mut view = View {
            flight: self,
            periods: periods(points, reach_s),
            inside: Vec::with_capacity(self.updates.len()),
            is_seen_inside: Vec::with_capacity(self.updates.len()),
        };
        for update in &self.updates {
            let is_inside = update.reference.is_some_and(|reference| {
                sector.holds(&reference.place, reference.height_m)
                    && reference.beside.into_iter().any(is_phase)
            });
            view.inside.push(is_inside);
            view.is_seen_inside
                .push(sector.holds(&update.place, update.height_m));
        }
        view
    }
}

impl View<'_> {
    /// Hours in which the target is due.
    pub fn hours(&self) -> f64 {
        let lengths = self.periods.iter().map(|(from_s, to_s)| to_s - from_s);
        lengths.sum::<f64>() / 3600.0
    }

    /// Updates whose reference is inside.
    pub fn judged(&self) -> impl Iterator<Item = (&Update, &Reference)> {
        let updates = self.flight.updates.iter().zip(&self.inside);
        let inside = updates.filter(|(_, is_inside)| **is_inside);
        inside.filter_map(|(update, _)| Some((update, update.reference.as_ref()?)))
    }
}
