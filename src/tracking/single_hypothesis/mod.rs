//! The tracker that keeps one hypothesis: after each scan an associator decides which detections continue which track, for good.
//!
//! # Method
//! Predict → gate → associate → update → manage, once a scan, first the confirmed tracks, then the tentative ones with what is
//! left; unused detections start tracks. Tracks with a probability of existence are served all at once.

pub mod confirmation;
mod crossing;
pub mod existence;
mod initiate;
pub mod initiation;
pub mod lifecycle;
mod members;
pub mod multi_scan;
mod scratch;
mod sight;
pub mod twins;
pub mod undetected;
mod update;
mod written;

use super::recorder::Recorder;
use super::{BuildTracker, Nis, ScanOutcome, TrackEstimate, Tracker, TrackerParts};
use crate::association::global_nearest_neighbour::GlobalNearestNeighbour;
use crate::association::problem::ScanProblem;
use crate::association::{Associator, Trace};
use crate::filtering::{Filter, WithFilter};
use crate::hypotheses::{About, Look, bounds};
use crate::model::fault::Fault;
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::sensor::Sensor;
use crate::model::sight::clutter::ClutterMap;
use crate::model::watch::{Halt, Watch};
use crate::registry::Method;
use crossing::Ray;
use existence::Counted;
use initiate::pair_rule;
use initiation::{Initiation, Initiator, PairRule};
use lifecycle::{LIFECYCLE, Lifecycle, TrackLifecycleState};
use multi_scan::Beginnings;
use scratch::Scratch;
use sight::{highest_p_d, new_map};
use twins::Pair;
use undetected::{Intensity, Undetected};

const NAME: &str = "single_hypothesis";

pub const METHOD: Method<BuildTracker> = Method {
    name: NAME,
    parameters: &LIFECYCLE,
    build: |parts| {
        build(TrackerParts {
            undetected: None,
            ..parts
        })
    },
};

/// The tracker of these parts; tracks begin from undetected targets where there are such.
pub(super) fn build(parts: TrackerParts) -> Box<dyn Tracker> {
    let filter = parts.filter;
    filter.with(Building(parts))
}

/// A detection to which a track gives at least this weight is used: neither do the tentative tracks see it after a
/// confirmed one used it, nor does it start a track. One that all tracks weigh less explains too little of any of them.
const USED_WEIGHT: f64 = 0.01;

/// A living track besides its belief.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ActiveTrack {
    serial: u32,
    life: TrackLifecycleState,
    /// The target that the first detection came from, for an associator that is told where detections came from.
    origin: Option<u32>,
}

/// What a tracker knows from scan to scan.
#[derive(Debug, Clone)]
struct Memory<B, const K: usize> {
    tracks: Vec<ActiveTrack>,
    /// Parallel to the tracks.
    beliefs: Vec<B>,
    /// Names of the tracks that were given; theirs are the first serials.
    given: Vec<String>,
    /// Tracks ever started; serials are below it.
    started: u32,
    last_time_s: Option<f64>,
    /// Scans taken.
    scans: u32,
    initiator: Initiator<K>,
    beginnings: Beginnings<K>,
    /// Targets that were never detected.
    intensity: Intensity<B>,
    /// What became of detections that no track wanted.
    counted: Counted,
    /// Bearings that no track used, of the last scan of each sensor.
    rays: Vec<Vec<Ray>>,
    /// Tracks that may be one, by serial.
    twins: Vec<Pair>,
    nis: Nis,
    /// One bit a sensor: which of them ever detected a confirmed track.
    finders: u64,
    /// Of each sensor that learns one.
    maps: Vec<Option<ClutterMap>>,
}

/// Its filter has kinematics of `K` variables.
struct SingleHypothesis<F: Filter<K>, const K: usize> {
    filter: F,
    associator: Box<dyn Associator>,
    lifecycle: Lifecycle,
    /// How tracks begin in place of the life cycle's initiation.
    undetected: Option<Undetected>,
    sensors: Vec<Sensor>,
    /// Of all sensors.
    highest_p_d: f64,
    /// Serves the tentative tracks in place of a soft associator.
    beginner: GlobalNearestNeighbour,
    /// Of two-point initiation.
    pair_rule: Option<PairRule>,
    memory: Memory<F::Belief, K>,
    /// The problems of the confirmed tracks, when they are kept, and how many candidates they have.
    kept: Option<(Vec<ScanProblem>, usize)>,
    scratch: Scratch<F, K>,
}

/// Makes the tracker of a filter.
struct Building(TrackerParts);

impl WithFilter for Building {
    type Output = Box<dyn Tracker>;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Box<dyn Tracker> {
        Box::new(SingleHypothesis::new(filter, self.0))
    }

    fn in_volume<F: Filter<6>>(self, filter: F) -> Box<dyn Tracker> {
        Box::new(SingleHypothesis::new(filter, self.0))
    }

    fn of_bearings<F: Filter<2>>(self, filter: F) -> Box<dyn Tracker> {
        Box::new(SingleHypothesis::new(filter, self.0))
    }
}

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    fn new(filter: F, parts: TrackerParts) -> Self {
        let (lifecycle, needs) = (parts.lifecycle, parts.associator.needs());
        let mut tracker = SingleHypothesis {
            filter,
            pair_rule: pair_rule(&lifecycle, needs, K),
            associator: parts.associator,
            lifecycle,
            undetected: parts.undetected,
            highest_p_d: highest_p_d(&parts.sensors),
            beginner: GlobalNearestNeighbour::default(),
            memory: Memory {
                tracks: Vec::new(),
                beliefs: Vec::new(),
                given: Vec::new(),
                started: 0,
                last_time_s: None,
                scans: 0,
                initiator: Initiator::default(),
                beginnings: Beginnings::default(),
                intensity: Intensity::default(),
                counted: Counted::default(),
                rays: Vec::new(),
                twins: Vec::new(),
                nis: Nis::default(),
                finders: 0,
                maps: parts.sensors.iter().map(new_map).collect(),
            },
            sensors: parts.sensors,
            kept: None,
            scratch: Scratch::new(lifecycle.gate_probability, needs),
        };
        for given in parts.given {
            tracker.add(given);
        }
        tracker
    }

    /// The problem of the confirmed tracks, or of the others and the detections still unused.
    fn hypothesise(
        &mut self,
        part: usize,
        (scan, report, step): (&Scan, &MeasurementModel, &F::Step),
        watch: &Watch,
    ) -> Result<(), Halt> {
        let Memory {
            tracks,
            beliefs,
            scans,
            ..
        } = &mut self.memory;
        let look = Look {
            filter: &self.filter,
            sensor: &self.sensors[scan.sensor],
            report,
            scan,
            step,
        };
        let hypotheses = &mut self.scratch.hypotheses;
        let members = &self.scratch.members[part];
        let about = |track: u32| About {
            origin: tracks[track as usize].origin,
            existence: tracks[track as usize].life.existence(),
        };
        // Each scan has two problems: of the confirmed tracks, then of the others.
        let problem_index = 2 * *scans + part as u32;
        hypotheses.write(look, problem_index, (beliefs, members), &about, watch)?;
        for &track in hypotheses.lost() {
            tracks[track as usize].life.end();
        }
        Ok(())
    }

    /// Associates and updates the tracks of the problem, confirmed or tentative ones.
    fn associate(
        &mut self,
        is_confirmed: bool,
        scan: &Scan,
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let (hypotheses, weights) = (&mut self.scratch.hypotheses, &mut self.scratch.weights);
        weights.reset(hypotheses.problem());
        if let Some((kept, candidates)) = self.kept.as_mut().filter(|_| is_confirmed) {
            kept.push(hypotheses.problem().clone());
            *candidates += hypotheses.problem().edges().len();
            bounds::check_timed(*candidates, scan)?;
        }
        // The gate of a track that is still without a speed holds much that is not its own. An average over all of that
        // would never become a speed, so soft weights begin when the track is confirmed.
        let associator: &mut dyn Associator = if !is_confirmed && self.associator.is_soft() {
            &mut self.beginner
        } else {
            self.associator.as_mut()
        };
        hypotheses
            .problem_mut()
            .for_each_cluster_until(watch, |cluster| associator.associate(cluster, weights));
        bounds::go_on(watch)?;
        for row in 0..self.scratch.hypotheses.problem().rows().len() {
            self.update(row, scan, recorder);
            recorder.check(scan)?;
            let count = self.scratch.hypotheses.problem().rows()[row].count;
            if watch.stops_after(8 * u64::from(count) + 64) {
                return Err(Halt::Stopped);
            }
        }
        Ok(())
    }
}

impl<B: Copy, const K: usize> Memory<B, K> {
    fn next_serial(&mut self) -> u32 {
        self.started += 1;
        self.started - 1
    }

    fn push(&mut self, track: ActiveTrack, belief: B) {
        self.tracks.push(track);
        self.beliefs.push(belief);
    }

    #[inline]
    fn track_mut(&mut self, index: usize) -> (&mut ActiveTrack, &mut B) {
        (&mut self.tracks[index], &mut self.beliefs[index])
    }
}

impl<F: Filter<K>, const K: usize> Tracker for SingleHypothesis<F, K> {
    fn step(
        &mut self,
        scan: &Scan,
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<ScanOutcome, Halt> {
        let last_s = self.memory.last_time_s.unwrap_or(scan.time_s);
        if scan.time_s < last_s {
            return Err(Halt::Late {
                time_s: scan.time_s,
                last_s,
            });
        }
        self.memory.last_time_s = Some(scan.time_s);
        let step = self.filter.step(scan.time_s - last_s);
        let started_before = if self.memory.scans == 0 {
            for (serial, name) in self.memory.given.iter().enumerate() {
                recorder.given(serial as u32, name);
            }
            0
        } else {
            self.memory.started
        };
        let report = self.sensors[scan.sensor].report_in(scan);
        self.survive(scan.time_s - last_s);
        self.begin(scan, &report);
        self.expect_undetected((scan, &report), scan.time_s - last_s, watch)?;
        self.sort_members();
        for (part, is_confirmed) in [(0, true), (1, false)] {
            self.hypothesise(part, (scan, &report, &step), watch)?;
            self.associate(is_confirmed, scan, recorder, watch)?;
            if is_confirmed {
                self.merge_twins(scan.time_s, recorder, watch)?;
                self.count_left(scan);
                self.learn_clutter(scan);
            }
        }
        let unused = self.initiate(scan, &report, recorder, watch)?;
        let confirmed = self.sweep(recorder);
        self.memory.scans += 1;
        Ok(ScanOutcome {
            tracks: self.memory.tracks.len() as u32,
            confirmed,
            unused,
            started: self.memory.started - started_before,
        })
    }

    fn tracks_at(&self, time_s: Option<f64>) -> Vec<TrackEstimate> {
        let last_s = self.memory.last_time_s.unwrap_or(0.0);
        let time_s = time_s.filter(|time_s| *time_s > last_s);
        let step = time_s.map(|time_s| self.filter.step(time_s - last_s));
        let mut estimates = Vec::with_capacity(self.memory.tracks.len());
        for (track, belief) in self.memory.tracks.iter().zip(&self.memory.beliefs) {
            let mut belief = *belief;
            if let Some(step) = &step {
                F::predict(step, &mut belief);
            }
            let mut kinematics = Vec::new();
            F::kinematics(&belief).pack_into(&mut kinematics);
            estimates.push(TrackEstimate {
                serial: track.serial,
                time_s: time_s.unwrap_or(last_s),
                status: track.life.status(),
                kinematics,
            });
        }
        estimates
    }

    fn begin(&mut self, kinematics: &[f64], recorder: &mut dyn Recorder) -> Option<u32> {
        self.begin_by_hand(kinematics, recorder)
    }

    fn forget(&mut self, serials: &[u32], recorder: &mut dyn Recorder) {
        for track in &mut self.memory.tracks {
            if serials.contains(&track.serial) {
                track.life.end();
            }
        }
        self.sweep(recorder);
    }

    fn finish(&mut self, recorder: &mut dyn Recorder) {
        if let Initiation::MultiScan(rule) = self.lifecycle.initiation {
            self.decide_rest(&rule, recorder);
        }
    }

    fn warnings(&self) -> Vec<String> {
        self.memory.beginnings.warnings()
    }

    fn fork(&self) -> Box<dyn Tracker> {
        let needs = self.associator.needs();
        Box::new(SingleHypothesis {
            filter: self.filter,
            associator: self.associator.fork(),
            lifecycle: self.lifecycle,
            undetected: self.undetected.clone(),
            sensors: self.sensors.clone(),
            highest_p_d: self.highest_p_d,
            beginner: GlobalNearestNeighbour::default(),
            pair_rule: self.pair_rule,
            memory: self.memory.clone(),
            kept: self.kept.clone(),
            scratch: Scratch::new(self.lifecycle.gate_probability, needs),
        })
    }

    fn write_down(&self) -> Vec<u8> {
        written::write::<F, K>(&self.memory, self.associator.as_ref())
    }

    fn read_back(&mut self, written: &[u8]) -> Result<(), Box<Fault>> {
        self.memory = written::read::<F, K>(written, &self.memory.maps, self.associator.as_mut())?;
        Ok(())
    }

    fn nis(&self) -> Nis {
        self.memory.nis
    }

    fn clutter_maps(&self) -> &[Option<ClutterMap>] {
        &self.memory.maps
    }

    fn diagnostics(&self) -> Option<serde_json::Value> {
        self.associator.diagnostics()
    }

    fn trace(&self) -> Option<&Trace> {
        self.associator.trace()
    }

    fn keep_problems(&mut self) {
        self.kept = Some((Vec::new(), 0));
    }

    fn decide_again(&mut self, watch: &Watch) {
        let (associator, weights) = (&mut self.associator, &mut self.scratch.weights);
        for problem in self.kept.iter_mut().flat_map(|(problems, _)| problems) {
            weights.reset(problem);
            problem.for_each_cluster_until(watch, |cluster| associator.associate(cluster, weights));
            if watch.is_stopped() {
                return;
            }
        }
    }
}
