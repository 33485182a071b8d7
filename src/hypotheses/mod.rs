//! Hypotheses: which detections of a scan each track may have caused, and how likely. The measurement's dimension is chosen here,
//! once a scan, by what its sensor reports; it shows in no result.
//!
//! # Method
//! 1. The detections of a scan become points of its sensor's measurement space, in a grid.
//! 2. Each track is predicted and its gate finds its candidates; what the filter would change for each is kept with its likelihood.
//!    For an associator that is told where detections came from, the candidate is the detection of the track's target instead.

pub mod bounds;
pub mod certain;
mod detections;
mod likelihood_constants;
mod locate;
mod look;
mod only;
mod own;
pub mod region;

pub use likelihood_constants::{LikelihoodConstants, Likelihoods};
pub use look::{About, Look};
pub use only::Only;

use crate::association::Needs;
use crate::association::problem::{Edge, ScanProblem};
use crate::filtering::{Corrector, Expected, Filter, Weighted, WithCorrector};
use crate::gating::ellipsoidal::EllipsoidalGate;
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::watch::{Halt, Watch};
use detections::Detections;
use std::ops::Range;

/// The hypotheses of one scan; memory is reused.
pub struct Hypotheses<F: Filter<K>, const K: usize> {
    gate: EllipsoidalGate,
    gate_probability: f64,
    needs: Needs,
    detections: Detections,
    problem: ScanProblem,
    /// The tracks of the problem's rows.
    rows: Vec<(u32, F::Loss)>,
    /// P_D of each.
    p_d: Vec<f64>,
    /// ln of the density of clutter at each detection over the sensor's; empty where it is that everywhere.
    log_clutter_ratios: Vec<f64>,
    /// Of each of the problem's edges.
    changes: Vec<F::Change>,
    /// The same of what they would lose; empty where that is what the row says.
    losses: Vec<F::Loss>,
    /// Detections near a track.
    near: Vec<u32>,
    /// Tracks of which nothing can be expected any more.
    lost: Vec<u32>,
}

impl<F: Filter<K>, const K: usize> Hypotheses<F, K> {
    pub fn new(gate_probability: f64, needs: Needs) -> Self {
        Hypotheses {
            gate: EllipsoidalGate::new(gate_probability),
            gate_probability,
            needs,
            detections: Detections::default(),
            problem: ScanProblem::default(),
            rows: Vec::new(),
            p_d: Vec::new(),
            log_clutter_ratios: Vec::new(),
            changes: Vec::new(),
            losses: Vec::new(),
            near: Vec::new(),
            lost: Vec::new(),
        }
    }

    /// Step 1. `clutter_ratios` says ln of the density of clutter at each detection over the sensor's; nothing where it is that
    /// everywhere.
    pub fn begin_scan(
        &mut self,
        filter: &F,
        report: &MeasurementModel,
        scan: &Scan,
        clutter_ratios: impl FnOnce(&mut Vec<f64>),
    ) {
        self.log_clutter_ratios.clear();
        clutter_ratios(&mut self.log_clutter_ratios);
        if self.needs == Needs::Amplitudes {
            // What has no amplitude is weaker than everything that has.
            self.problem.set_amplitudes(
                scan.detections
                    .iter()
                    .map(|detection| detection.amplitude.unwrap_or(f64::NEG_INFINITY)),
            );
        }
        let work = Reading {
            hypotheses: self,
            scan,
        };
        filter.correct(report, work);
    }

    /// Step 2: predicts the named tracks and writes a problem of them; `problem_index` numbers the problems of a tracker.
    ///
    /// # Errors
    /// When there are too many candidates, or the watch says to stop.
    pub fn write(
        &mut self,
        look: Look<F, F::Step>,
        problem_index: u32,
        (beliefs, members): (&mut [F::Belief], &[u32]),
        about: &dyn Fn(u32) -> About,
        watch: &Watch,
    ) -> Result<(), Halt> {
        self.write_among(look, problem_index, (beliefs, members, None), about, watch)
    }

    /// The same where what some of the tracks may have caused is told: the gate still decides.
    ///
    /// # Errors
    /// As [`Hypotheses::write`].
    pub fn write_among(
        &mut self,
        look: Look<F, F::Step>,
        problem_index: u32,
        (beliefs, members, only): (&mut [F::Belief], &[u32], Option<&Only>),
        about: &dyn Fn(u32) -> About,
        watch: &Watch,
    ) -> Result<(), Halt> {
        self.problem.begin(problem_index, self.detections.len());
        self.rows.clear();
        self.p_d.clear();
        self.changes.clear();
        self.losses.clear();
        self.lost.clear();
        let work = Writing {
            likelihoods: Likelihoods::new(look.sensor, look.scan, self.gate_probability),
            hypotheses: self,
            look,
            beliefs,
            members,
            only,
            about,
            watch,
        };
        look.filter.correct(look.report, work).unwrap_or(Ok(()))
    }

    pub fn problem(&self) -> &ScanProblem {
        &self.problem
    }

    pub fn problem_mut(&mut self) -> &mut ScanProblem {
        &mut self.problem
    }

    /// The track of a row.
    #[inline]
    pub fn track(&self, row: usize) -> usize {
        self.rows[row].0 as usize
    }

    /// Updates the belief of a row's track by its detections, each weighted by its weight times `scale`; they are left in `weighted`.
    #[inline]
    pub fn update(
        &self,
        row: usize,
        (weights, scale): (&[f64], f64),
        weighted: &mut Vec<Weighted<F::Change>>,
        belief: &mut F::Belief,
    ) {
        let edges = self.problem.rows()[row].edges();
        self.weigh(edges.clone(), (weights, scale), weighted);
        if self.losses.is_empty() {
            F::update(belief, &self.rows[row].1, weighted);
        } else {
            self.update_by_own(edges, weights, weighted, belief);
        }
    }

    /// The same where each detection has a loss of its own.
    #[inline(never)]
    fn update_by_own(
        &self,
        edges: Range<usize>,
        weights: &[f64],
        weighted: &[Weighted<F::Change>],
        belief: &mut F::Belief,
    ) {
        let used = edges.filter(|&edge| weights[edge] > 0.0);
        let losses: Vec<F::Loss> = used.map(|edge| self.losses[edge]).collect();
        F::update(belief, &F::mean_loss(&losses, weighted), weighted);
    }

    /// Updates a belief of a row's track as if the detection of this edge were certainly its.
    pub fn take(&self, row: usize, edge: usize, belief: &mut F::Belief) {
        let certain = Weighted {
            change: self.changes[edge],
            weight: 1.0,
        };
        let loss = self.losses.get(edge).unwrap_or(&self.rows[row].1);
        F::update(belief, loss, &[certain]);
    }

    /// Writes the changes of edges that have a weight.
    #[inline]
    fn weigh(
        &self,
        edges: Range<usize>,
        (weights, scale): (&[f64], f64),
        weighted: &mut Vec<Weighted<F::Change>>,
    ) {
        weighted.clear();
        for edge in edges {
            if weights[edge] > 0.0 {
                weighted.push(Weighted {
                    change: self.changes[edge],
                    weight: weights[edge] * scale,
                });
            }
        }
    }

    /// The normalised innovation squared of a detection that an edge gives to its track.
    #[inline]
    pub fn fit(&self, edge: usize) -> f64 {
        let squared_distance = self.problem.edges()[edge].squared_distance;
        F::fit(&self.changes[edge], squared_distance)
    }

    /// How probable it was that the sensor detects the target of a row.
    #[inline]
    pub fn p_d(&self, row: usize) -> f64 {
        self.p_d[row]
    }

    /// From now on so much more than clutter is expected at each detection: a multiple of the clutter there.
    pub fn crowd(&mut self, more: impl Iterator<Item = f64>) {
        self.log_clutter_ratios.resize(self.detections.len(), 0.0);
        for (ratio, more) in self.log_clutter_ratios.iter_mut().zip(more) {
            *ratio += more.ln_1p();
        }
    }

    /// Whether clutter is denser at some detections than at others.
    pub fn has_log_clutter_ratios(&self) -> bool {
        !self.log_clutter_ratios.is_empty()
    }

    /// ln of the density of clutter at a detection over the sensor's.
    #[inline]
    pub fn log_clutter_ratio(&self, detection: usize) -> f64 {
        let ratio = self.log_clutter_ratios.get(detection);
        ratio.copied().unwrap_or_default()
    }

    /// The tracks of which nothing can be expected any more: their covariance has left the range of numbers.
    pub fn lost(&self) -> &[u32] {
        &self.lost
    }

    /// From now on nobody else gets this detection.
    #[inline]
    pub fn mark_used(&mut self, detection: u32) {
        self.detections.used[detection as usize] = true;
    }

    #[inline]
    pub fn is_used(&self, detection: usize) -> bool {
        self.detections.used[detection]
    }

    /// Detections that no track uses.
    pub fn unused(&self) -> u32 {
        let is_unused = self.detections.used.iter().filter(|is_used| !**is_used);
        is_unused.count() as u32
    }

    /// Adds the detections that may be a track's to the open row.
    #[inline(always)]
    fn push_edges<C: Corrector<F, K, D>, const D: usize>(
        &mut self,
        corrector: &C,
        constants: &LikelihoodConstants,
        (origin, only): (Option<u32>, Option<&[u32]>),
        (expected, gain): &(Expected<D>, C::Gain),
    ) {
        let log_scale = corrector.log_clutter_scale(&expected.measurement);
        let log_density = constants.log_density - log_scale;
        let (problem, changes) = (&mut self.problem, &mut self.changes);
        let ratios = self.log_clutter_ratios.as_slice();
        let mut found = |detection: u32, innovation, squared_distance| {
            let (change, log_there) = C::assess(gain, expected, &innovation, squared_distance);
            changes.push(change);
            let more_clutter = ratios.get(detection as usize).copied().unwrap_or_default();
            problem.push_edge(Edge {
                detection,
                squared_distance,
                log_likelihood: log_density + log_there - more_clutter,
            });
        };
        let (detections, gate) = (&self.detections, &self.gate);
        let around = (expected, gain);
        match self.needs {
            // What the sensor does not see it does not report.
            Needs::OriginsInGates if constants.p_d <= 0.0 => self.problem.push_own(None),
            _ if constants.p_d <= 0.0 => {}
            Needs::Origins => detections.of_target(origin, expected, C::ANGLE, found),
            Needs::OriginsInGates => {
                let own = detections.own(origin);
                detections.of_target(origin, expected, C::ANGLE, &mut found);
                detections.inside::<C, F, K, D>(gate, around, |detection, innovation, squared| {
                    if Some(detection) != own {
                        found(detection, innovation, squared);
                    }
                });
                self.problem.push_own(own);
            }
            _ => match only {
                None => detections.inside::<C, F, K, D>(gate, around, found),
                Some(only) => detections.among::<C, F, K, D>(gate, around, only, found),
            },
        }
    }

    /// Ends the row of a track that expects this.
    #[inline(always)]
    fn end_row<C: Corrector<F, K, D>, const D: usize>(
        &mut self,
        corrector: &C,
        constants: &LikelihoodConstants,
        track: u32,
        (expected, gain): &(Expected<D>, C::Gain),
    ) {
        if self.needs == Needs::Places {
            self.problem.push_place(
                expected.measurement.as_slice(),
                expected.gaussian.inverse().as_slice(),
            );
        }
        let more_clutter = self.mean_log_clutter_ratio();
        self.problem.end_row(
            constants.log_missed,
            constants.log_clutter
                + more_clutter
                + corrector.log_clutter_scale(&expected.measurement)
                + self.gate.log_volume(&expected.gaussian),
        );
        self.rows.push((track, C::loss(gain)));
        self.p_d.push(constants.p_d);
    }

    /// ln of the density of clutter over the sensor's, on average at the candidates of the row that is written.
    fn mean_log_clutter_ratio(&self) -> f64 {
        if self.log_clutter_ratios.is_empty() {
            return 0.0;
        }
        let edges = self.problem.open_edges().iter();
        let ratios = edges.map(|edge| self.log_clutter_ratios[edge.detection as usize]);
        ratios.sum::<f64>() / self.problem.open_edges().len().max(1) as f64
    }

    /// Whether the problem, as far as it is written, is small enough, and whether to go on.
    #[inline]
    fn check(&self, scan: &Scan, watch: &Watch) -> Result<(), Halt> {
        bounds::check_scan(self.problem.edges().len(), scan)?;
        let candidates = self.problem.rows().last().map_or(0, |row| row.count);
        if watch.stops_after(8 * u64::from(candidates) + 64) {
            Err(Halt::Stopped)
        } else {
            Ok(())
        }
    }
}

struct Reading<'a, F: Filter<K>, const K: usize> {
    hypotheses: &'a mut Hypotheses<F, K>,
    scan: &'a Scan,
}

impl<F: Filter<K>, const K: usize> WithCorrector<F, K> for Reading<'_, F, K> {
    type Output = ();

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) {
        let Hypotheses {
            needs,
            detections,
            problem,
            ..
        } = self.hypotheses;
        let found = self.scan.detections.iter().enumerate();
        let values = found.filter_map(|(index, detection)| {
            corrector.read(&detection.measurement, &self.scan.own_of(index))
        });
        detections.read(values.map(|values| values.data.0[0]));
        debug_assert_eq!(
            detections.len(),
            self.scan.detections.len(),
            "only reports that the filter can use are let through"
        );
        if needs.is_by_origin() {
            detections.index_origins(&self.scan.detections);
        }
        if *needs != Needs::Origins {
            detections.arrange::<D>();
        }
        if *needs == Needs::Places {
            let points = detections.points::<D>().iter();
            problem.set_measurements(D, C::ANGLE, points.map(|point| &point[..]));
        }
    }
}

struct Writing<'a, F: Filter<K>, const K: usize> {
    hypotheses: &'a mut Hypotheses<F, K>,
    likelihoods: Likelihoods<'a>,
    look: Look<'a, F, F::Step>,
    beliefs: &'a mut [F::Belief],
    members: &'a [u32],
    only: Option<&'a Only>,
    /// Called by name: a type of its own would compile all this once more for each caller.
    about: &'a dyn Fn(u32) -> About,
    watch: &'a Watch<'a>,
}

impl<F: Filter<K>, const K: usize> WithCorrector<F, K> for Writing<'_, F, K> {
    type Output = Result<(), Halt>;

    /// One pass: a large scene does not fit into the caches.
    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) -> Result<(), Halt> {
        let has_own = !self.look.scan.own.is_empty();
        let bounds = has_own.then(|| own::Bounds::of(self.look.scan));
        for (nth, &track) in self.members.iter().enumerate() {
            let belief = &mut self.beliefs[track as usize];
            F::predict(self.look.step, belief);
            let Some(expected) = corrector.expect(belief) else {
                self.hypotheses.lost.push(track);
                continue;
            };
            let About { origin, existence } = (self.about)(track);
            let constants = self.likelihoods.of(existence, || F::kinematics(belief));
            let hypotheses = &mut *self.hypotheses;
            let only = self.only.and_then(|only| only.of(nth));
            match &bounds {
                None => hypotheses.push_edges(corrector, &constants, (origin, only), &expected),
                Some(bounds) => hypotheses.push_own_edges(&own::Track {
                    corrector,
                    belief: &*belief,
                    expected: &expected.0.measurement,
                    scan: self.look.scan,
                    bounds,
                    constants: &constants,
                    origin,
                    only,
                }),
            }
            hypotheses.end_row(corrector, &constants, track, &expected);
            self.hypotheses.check(self.look.scan, self.watch)?;
        }
        Ok(())
    }
}
