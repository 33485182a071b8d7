//! The composition of filter, gate, associator and life cycle that turns scans into tracks.

mod initiate;

use super::bounds::{self, Bounds};
use super::confirmation;
use super::history::{Entry, History};
use super::initiation::{Initiator, PairRule};
use super::lifecycle::{Lifecycle, TrackLifecycleState};
use super::likelihood_constants::LikelihoodConstants;
use super::outcome::{Nis, ScanOutcome};
use super::scan_view::ScanView;
use crate::association::global_nearest_neighbour::GlobalNearestNeighbour;
use crate::association::problem::{Edge, ScanProblem, Weights};
use crate::association::{Associator, Needs, Trace};
use crate::filtering::Filter;
use crate::filtering::mixture::{self, Correction, WeightedInnovation};
use crate::filtering::prediction::Transition;
use crate::gating::ellipsoidal::EllipsoidalGate;
use crate::model::scan::{Detection, Scan};
use crate::model::sensor::Sensor;
use crate::model::state::GaussianState;
use crate::model::track::Candidate;
use crate::model::watch::{Halt, Watch};
use initiate::pair_rule;
use nalgebra::SVector;

/// What a tracker is made of.
pub struct TrackerParts<F> {
    pub filter: F,
    pub associator: Box<dyn Associator>,
    pub lifecycle: Lifecycle,
    /// In the order of the recording's sensors.
    pub sensors: Vec<Sensor>,
}

/// A living track.
#[derive(Debug, Clone)]
struct ActiveTrack<const N: usize> {
    serial: u32,
    life: TrackLifecycleState,
    state: GaussianState<N>,
    /// The target that the first detection came from; only the oracle looks at it.
    origin: Option<u32>,
}

/// A multi-target tracker whose filter has states of `N` variables and takes measurements of `D` values. Feed it scans in
/// order of time.
pub struct Tracker<F, const N: usize, const D: usize> {
    parts: TrackerParts<F>,
    /// Serves the tentative tracks in place of a soft associator.
    beginner: GlobalNearestNeighbour,
    gate: EllipsoidalGate<D>,
    initiator: Initiator<N>,
    /// Of two-point initiation.
    pair_rule: Option<PairRule>,
    tracks: Vec<ActiveTrack<N>>,
    last_time_s: Option<f64>,
    scans: u32,
    history: History,
    nis: Nis,
    view: ScanView<D>,
    problem: ScanProblem,
    /// The problems of the confirmed tracks, when they are kept.
    kept: Option<Vec<ScanProblem>>,
    bounds: Bounds,
    weights: Weights,
    /// Indices of the tracks that are not yet confirmed.
    tentative: Vec<usize>,
    /// The tracks of the problem's rows.
    row_tracks: Vec<(usize, Correction<N, D>)>,
    /// ν of each of the problem's edges.
    edge_innovations: Vec<SVector<f64, D>>,
    innovations: Vec<WeightedInnovation<D>>,
}

impl<F: Filter<N, D>, const N: usize, const D: usize> Tracker<F, N, D> {
    pub fn new(parts: TrackerParts<F>) -> Self {
        let gate = EllipsoidalGate::new(parts.lifecycle.gate_probability);
        let pair_rule = pair_rule::<F, N, D>(&parts);
        Tracker {
            parts,
            beginner: GlobalNearestNeighbour::default(),
            gate,
            initiator: Initiator::default(),
            pair_rule,
            tracks: Vec::new(),
            last_time_s: None,
            scans: 0,
            history: History::new(N),
            nis: Nis::default(),
            view: ScanView::default(),
            problem: ScanProblem::default(),
            kept: None,
            bounds: Bounds::default(),
            weights: Weights::default(),
            tentative: Vec::new(),
            row_tracks: Vec::new(),
            edge_innovations: Vec::new(),
            innovations: Vec::new(),
        }
    }

    /// A track that is there from the start and never ends: its state at the time of the first scan, its name, and its target
    /// for the oracle. To be called before the first scan.
    pub fn add_track(&mut self, name: String, state: GaussianState<N>, origin: Option<u32>) {
        debug_assert!(
            self.scans == 0 && self.history.started as usize == self.tracks.len(),
            "given tracks come before all others"
        );
        let serial = self.history.started;
        self.history.started += 1;
        self.history.names.push(name);
        self.history.confirmed.push(serial);
        self.tracks.push(ActiveTrack {
            serial,
            life: TrackLifecycleState::permanent(),
            state,
            origin,
        });
    }

    /// Predict, gate, associate, update and manage, for one scan and its detections. Stops when the watch says so; then the
    /// tracker is of no use any more.
    ///
    /// # Errors
    /// [`Halt::Stopped`], and [`Halt::TooLarge`] when there are more candidates than a tracker may hold.
    pub fn step(
        &mut self,
        scan: &Scan,
        detections: &[Detection],
        watch: &Watch,
    ) -> Result<ScanOutcome, Halt> {
        let transition = self.transition(scan.time_s);
        let needs = self.parts.associator.needs();
        self.view.rebuild(
            &self.parts.filter,
            &self.parts.sensors[scan.sensor],
            detections,
            needs,
        );
        if needs == Needs::Amplitudes {
            // What has no amplitude is weaker than everything that has.
            self.problem.set_amplitudes(
                detections
                    .iter()
                    .map(|detection| detection.amplitude.unwrap_or(f64::NEG_INFINITY)),
            );
        }
        if needs == Needs::Places {
            let measurements = self
                .view
                .measurements
                .iter()
                .map(|measurement| measurement.as_slice());
            self.problem
                .set_measurements(D, self.view.angle, measurements);
        }
        self.hypothesise_confirmed(scan, &transition, watch)?;
        self.associate(scan, true, watch)?;
        self.hypothesise_tentative(scan, watch)?;
        self.associate(scan, false, watch)?;
        let started_before = if self.scans == 0 {
            0
        } else {
            self.history.started
        };
        let unused = self.initiate(scan, detections, watch)?;
        let mut confirmed = 0;
        self.tracks.retain(|track| {
            let goes_on = !track.life.is_over();
            confirmed += u32::from(goes_on && track.life.is_confirmed());
            goes_on
        });
        self.scans += 1;
        Ok(ScanOutcome {
            tracks: self.tracks.len() as u32,
            confirmed,
            unused,
            started: self.history.started - started_before,
        })
    }

    /// What the associator says of all it did so far.
    pub fn diagnostics(&self) -> Option<serde_json::Value> {
        self.parts.associator.diagnostics()
    }

    /// What the associator wrote down step by step.
    pub fn trace(&self) -> Option<&Trace> {
        self.parts.associator.trace()
    }

    /// How well the detections fitted so far.
    pub fn nis(&self) -> Nis {
        self.nis
    }

    /// Everything that happened so far.
    pub fn into_history(self) -> History {
        self.history
    }

    /// The motion of all tracks from the scan before to this one.
    fn transition(&mut self, time_s: f64) -> Transition<N> {
        let dt_s = self.last_time_s.map_or(0.0, |last| time_s - last);
        self.last_time_s = Some(time_s);
        Transition::new(self.parts.filter.motion(), dt_s)
    }

    /// From now on the problems of the confirmed tracks are kept, for [`Tracker::decide_again`].
    pub fn keep_problems(&mut self) {
        self.kept = Some(Vec::new());
    }

    /// Gives the kept problems to the associator once more, and does nothing with what it says: for those who time it.
    pub fn decide_again(&mut self, watch: &Watch) {
        let (associator, weights) = (&mut self.parts.associator, &mut self.weights);
        for problem in self.kept.iter_mut().flatten() {
            weights.reset(problem);
            problem.for_each_cluster_until(watch, |cluster| associator.associate(cluster, weights));
            if watch.is_stopped() {
                return;
            }
        }
    }

    /// Associates and updates the tracks of the problem, confirmed or tentative ones.
    fn associate(&mut self, scan: &Scan, confirmed: bool, watch: &Watch) -> Result<(), Halt> {
        self.weights.reset(&self.problem);
        if let Some(kept) = self.kept.as_mut().filter(|_| confirmed) {
            kept.push(self.problem.clone());
            self.bounds.keep(self.problem.edges().len(), scan)?;
        }
        // The gate of a track that is still without a speed holds much that is not its own. An average over all of that
        // would never become a speed, so soft weights begin when the track is confirmed.
        let is_beginner = !confirmed && self.parts.associator.is_soft();
        let associator: &mut dyn Associator = if is_beginner {
            &mut self.beginner
        } else {
            self.parts.associator.as_mut()
        };
        let weights = &mut self.weights;
        self.problem
            .for_each_cluster_until(watch, |cluster| associator.associate(cluster, weights));
        bounds::go_on(watch)?;
        for row in 0..self.row_tracks.len() {
            self.update(row, scan);
            self.bounds.check_history(self.history.surplus, scan)?;
            if watch.stops_after(8 * u64::from(self.problem.rows()[row].count) + 64) {
                return Err(Halt::Stopped);
            }
        }
        Ok(())
    }

    /// Predicts all tracks and writes the association problem of the confirmed ones: one pass, for a large scene does not
    /// fit into the caches.
    fn hypothesise_confirmed(
        &mut self,
        scan: &Scan,
        transition: &Transition<N>,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let constants = self.begin_problem(scan, 0);
        self.tentative.clear();
        for index in 0..self.tracks.len() {
            let track = &mut self.tracks[index];
            transition.predict(&mut track.state);
            if track.life.is_confirmed() {
                self.hypothesise(index, scan, &constants);
                self.check_hypotheses(scan, watch)?;
            } else {
                self.tentative.push(index);
            }
        }
        Ok(())
    }

    /// Writes the problem of the others and the detections still unused.
    fn hypothesise_tentative(&mut self, scan: &Scan, watch: &Watch) -> Result<(), Halt> {
        let constants = self.begin_problem(scan, 1);
        for place in 0..self.tentative.len() {
            self.hypothesise(self.tentative[place], scan, &constants);
            self.check_hypotheses(scan, watch)?;
        }
        Ok(())
    }

    /// Whether the problem, as far as it is written, is small enough, and whether to go on.
    #[inline]
    fn check_hypotheses(&self, scan: &Scan, watch: &Watch) -> Result<(), Halt> {
        bounds::check_scan(self.problem.edges().len(), scan)?;
        let candidates = self.problem.rows().last().map_or(0, |row| row.count);
        if watch.stops_after(8 * u64::from(candidates) + 64) {
            Err(Halt::Stopped)
        } else {
            Ok(())
        }
    }

    /// Each scan has two problems: of the confirmed tracks, then of the others.
    fn begin_problem(&mut self, scan: &Scan, part: u32) -> LikelihoodConstants {
        self.problem
            .begin(2 * self.scans + part, self.view.measurements.len());
        self.edge_innovations.clear();
        self.row_tracks.clear();
        LikelihoodConstants::new(
            &self.parts.sensors[scan.sensor],
            self.parts.lifecycle.gate_probability,
        )
    }

    /// Gates one track and adds it to the problem.
    #[inline(always)]
    fn hypothesise(&mut self, index: usize, scan: &Scan, constants: &LikelihoodConstants) {
        let sensor = &self.parts.sensors[scan.sensor];
        let track = &mut self.tracks[index];
        let Some(expected) = self.parts.filter.expect(&track.state, sensor) else {
            // Its covariance has left the range of numbers: nothing can be expected of it any more.
            track.life.end();
            return;
        };
        let log_scale = self.parts.filter.log_clutter_scale(sensor, &expected);
        let log_density = constants.log_density - log_scale;
        let (problem, innovations) = (&mut self.problem, &mut self.edge_innovations);
        self.view.candidates(
            &self.gate,
            track.origin,
            &expected,
            |detection, innovation, squared_distance| {
                innovations.push(innovation);
                let log_likelihood = log_density + expected.gaussian.log_density(squared_distance);
                problem.push_edge(Edge {
                    detection,
                    squared_distance,
                    log_likelihood,
                });
            },
        );
        if self.parts.associator.needs() == Needs::Places {
            self.problem.push_place(
                expected.measurement.as_slice(),
                expected.gaussian.inverse().as_slice(),
            );
        }
        self.problem.end_row(
            constants.log_missed,
            constants.log_clutter + log_scale + self.gate.log_volume(&expected.gaussian),
        );
        self.row_tracks.push((index, expected.correction()));
    }

    /// Updates the track of one row by its weights, and remembers what was decided.
    fn update(&mut self, row: usize, scan: &Scan) {
        let lifecycle = self.parts.lifecycle;
        let log_ratio = if lifecycle.is_scored() {
            confirmation::log_ratio(&self.problem, &self.weights, row)
        } else {
            0.0
        };
        let (index, correction) = &self.row_tracks[row];
        let track = &mut self.tracks[*index];
        let first_candidate = self.history.candidates.len();
        self.innovations.clear();
        let mut weighted_nis = 0.0;
        for edge_index in self.problem.rows()[row].edges() {
            let weight = self.weights.edges[edge_index];
            if weight > 0.0 {
                let Edge {
                    detection,
                    squared_distance,
                    ..
                } = self.problem.edges()[edge_index];
                self.innovations.push(WeightedInnovation {
                    innovation: self.edge_innovations[edge_index],
                    weight,
                });
                weighted_nis += weight * squared_distance;
                let detection = Some(scan.first as u32 + detection);
                self.history.candidates.push(Candidate {
                    detection,
                    probability: weight,
                });
            }
        }
        if self.weights.missed[row] > 0.0 {
            self.history.candidates.push(Candidate {
                detection: None,
                probability: self.weights.missed[row],
            });
        }
        mixture::update(&mut track.state, correction, &self.innovations);
        let was_confirmed = track.life.is_confirmed();
        // The scan is a hit when it is more probable that the track was detected than that it was not.
        let detected: f64 = self
            .innovations
            .iter()
            .map(|innovation| innovation.weight)
            .sum();
        lifecycle.advance(
            &mut track.life,
            detected > self.weights.missed[row],
            log_ratio,
        );
        lifecycle.limit(&mut track.life, &track.state.covariance);
        if track.life.is_over() {
            // It ends before this scan: what nobody carries on is not a track any more, and uses nothing.
            self.history.candidates.truncate(first_candidate);
        } else {
            self.view
                .mark_used(&self.history.candidates[first_candidate..], scan);
            if was_confirmed && detected > 0.0 {
                self.nis.weighted_sum += weighted_nis;
                self.nis.weight += detected;
                self.nis.updates += 1;
            }
            let nis = (detected > 0.0).then(|| weighted_nis / detected);
            self.history
                .remember(track, self.scans, first_candidate, was_confirmed, nis);
        }
    }
}

impl History {
    fn remember<const N: usize>(
        &mut self,
        track: &ActiveTrack<N>,
        scan: u32,
        first_candidate: usize,
        was_confirmed: bool,
        nis: Option<f64>,
    ) {
        if track.life.is_confirmed() && !was_confirmed {
            self.confirmed.push(track.serial);
        }
        let entry = Entry {
            serial: track.serial,
            scan,
            status: track.life.status(),
            candidates: (self.candidates.len() - first_candidate) as u32,
            nis: nis.unwrap_or(f64::NAN),
        };
        self.push(entry, &track.state);
    }
}
