//! How tracks begin. One point: every detection that no track used is a track at rest. Two points: such a detection waits
//! for the next scan of its sensor, and the two together are a track with a speed. Several scans: [`super::multi_scan`]. Truth: the tracker was given its tracks
//! before the first scan, and no detection starts another one.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.5.3
//! (two-point differencing).
//!
//! # Symbols
//! z₁, z₂ places of the two detections and R₁, R₂ their covariances; Δ = z₂ − z₁; T time between them; γ the gate's threshold on d².
//!
//! # Method
//! 1. z₂ is within reach of z₁ when |Δ| ≤ `max_speed_mps` T + √(γ σ²), σ² the variance of Δ along itself.
//! 2. All pairs within reach compete at once: those are taken whose squares |Δ|² have the least sum, where a first point that
//!    stays alone counts as the square of its reach. Each detection is in one pair at most.
//! 3. x̂ = (z₂, Δ / T); P has the blocks R₂, R₂ / T and (R₁ + R₂) / T² + w, with w the variance that the motion's noise gives a
//!    rate around its mean over T: q T / 3 of nearly constant velocity.
//!
//! The first points are those of the sensor's last `max_wait_scans` scans that have no partner yet, each with a reach of its own
//! T; what is new and alone waits in its turn. Ranges and bearings are turned into places for this; range rates are left to the first update.

use super::multi_scan::MultiScan;
use crate::association::Associator;
use crate::association::global_nearest_neighbour::GlobalNearestNeighbour;
use crate::association::problem::{Edge, ScanProblem, Weights};
use crate::gating::grid::Grid;
use crate::hypotheses::bounds;
use crate::math::gaussian::log_unit_ball;
use crate::model::scan::Scan;
use crate::model::state::GaussianState;
use crate::model::watch::{Halt, Watch};
use crate::registry::{Object, Union, above, default, optional, variant, whole};
use serde::Deserialize;

/// How a track begins.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "method", rename_all = "snake_case")]
pub enum Initiation {
    OnePoint,
    TwoPoint {
        #[serde(default = "assumed_max_speed_mps")]
        max_speed_mps: f64,
        max_wait_scans: u32,
    },
    MultiScan(MultiScan),
    /// The sigmas are of the rates of the given tracks, which others make.
    Truth {
        speed_sigma_mps: f64,
        rate_sigma_degps: f64,
    },
}

/// Highest speed of a target over the standard deviation of a component of its velocity, where one of them alone is known.
pub const SPEED_REACH: f64 = 2.5;

/// That of what is assumed of tracks of one point.
fn assumed_max_speed_mps() -> f64 {
    SPEED_REACH * super::lifecycle::Lifecycle::ASSUMED_SPEED_SIGMA_MPS
}

static ONE_POINT: Object = Object {
    name: "OnePointInitiation",
    summary: "Every unused detection starts a track at rest, with initial_speed_sigma_mps as the uncertainty of its velocity.",
    fields: &[],
};

static TWO_POINT: Object = Object {
    name: "TwoPointInitiation",
    summary: "Two unused detections of near scans of a sensor start a track; their difference is its velocity.",
    fields: &[
        optional(
            "max_speed_mps",
            "Highest speed of a target: two detections further apart, noise allowed for, are not a pair. When absent, it follows from the targets of a scenario or is estimated from the data, and the report tells it.",
            above(0.0, 1e5, "m/s"),
        ),
        default(
            "max_wait_scans",
            "How many further scans of its sensor a first detection waits for a second one: 1 for the next scan alone, more where targets are missed often, at the price of more false tracks.",
            whole(1, 10, "scans"),
            "1",
        ),
    ],
};

static MULTI_SCAN: Object = Object {
    name: "MultiScanInitiation",
    summary: "The unused detections of a sensor that follow each other best over a window of its scans start a track, chosen together; it is known when the window ends, with its points since the first detection.",
    fields: &[
        optional(
            "max_speed_mps",
            "Highest speed of a target between its first two detections, noise allowed for; 2.5 times initial_speed_sigma_mps when absent.",
            above(0.0, 1e5, "m/s"),
        ),
        default(
            "window_scans",
            "Scans of a sensor, the one of the first detection counted, after which it is decided whether a track begins with that.",
            whole(2, 10, "scans"),
            "5",
        ),
        default(
            "min_detections",
            "How many detections within the window a beginning needs at least.",
            whole(2, 10, ""),
            "3",
        ),
        default(
            "max_gap_scans",
            "How many scans in a row may miss it.",
            whole(0, 8, "scans"),
            "2",
        ),
        default(
            "max_nodes",
            "How many threes of detections that may follow each other are kept of a scan, and how many ways from detection to detection of a choice; the crookedest threes and the least likely ways of each first detection go first, which is told.",
            whole(100, 1_000_000, ""),
            "20000",
        ),
    ],
};

static TRUTH: Object = Object {
    name: "TruthInitiation",
    summary: "Tracks begin at the truth of the first scan, with noise; nothing else begins a track and these never end: for comparing associators alone. A track is called like its target. It needs truth with the input.",
    fields: &[
        default(
            "speed_sigma_mps",
            "Standard deviation of each velocity component of a track in the plane; its position has the noise of one detection.",
            above(0.0, 1e5, "m/s"),
            "0.1",
        ),
        default(
            "rate_sigma_degps",
            "Standard deviation of the bearing rate of a track of bearings; its bearing has the noise of one detection.",
            above(0.0, 360.0, "deg/s"),
            "0.1",
        ),
    ],
};

pub(super) static INITIATION: Union = Union {
    name: "Initiation",
    summary: "How tracks begin.",
    tag: "method",
    variants: || {
        vec![
            variant("one_point", &ONE_POINT),
            variant("two_point", &TWO_POINT),
            variant("multi_scan", &MULTI_SCAN),
            variant("truth", &TRUTH),
        ]
    },
};

/// An unused detection as a state without a known speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point<const K: usize> {
    /// How many scans there were before its own.
    pub scan_index: u32,
    pub time_s: f64,
    /// Index of its sensor.
    pub sensor: usize,
    /// Its index in its scan.
    pub detection: u32,
    pub origin: Option<u32>,
    /// How long after its scan the detection was made (s).
    pub after_s: f64,
    /// At the time of the detection.
    pub state: GaussianState<K>,
}

impl<const K: usize> Point<K> {
    /// When the detection was made.
    pub fn at_s(&self) -> f64 {
        self.time_s + self.after_s
    }

    /// As it is at the time of its scan.
    pub fn in_scan(&self) -> GaussianState<K> {
        self.state.coasted::<K>(-self.after_s)
    }
}

/// Two points that are a track.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair<const K: usize> {
    pub first: Point<K>,
    pub second: Point<K>,
    /// State at the time of the second detection, without what the motion's noise adds.
    pub state: GaussianState<K>,
    /// Volume of the places within the first point's reach.
    pub log_reach_volume: f64,
    /// Scans of the sensor between the two.
    pub missed: u32,
}

/// What makes two points a pair.
#[derive(Debug, Clone, Copy)]
pub(super) struct PairRule {
    pub max_speed_mps: f64,
    /// Scans for which a first point waits.
    pub max_wait_scans: u32,
    /// γ.
    pub gate_threshold: f64,
    /// For the oracle: only points of one target.
    pub by_origin: bool,
}

/// A first point, and how many scans of its sensor passed without a second one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Waiting<const K: usize> {
    pub point: Point<K>,
    pub missed: u32,
}

/// The points that wait for a second one; memory is reused.
#[derive(Debug, Clone)]
pub(super) struct Initiator<const K: usize> {
    /// Those of each sensor, the longest waiting first.
    waiting: Vec<Vec<Waiting<K>>>,
    /// Those of the current scan.
    fresh: Vec<Point<K>>,
    places: Vec<[f64; K]>,
    grid: Grid,
    problem: ScanProblem,
    weights: Weights,
    solver: GlobalNearestNeighbour,
    is_paired: Vec<bool>,
    pairs: Vec<Pair<K>>,
}

impl<const K: usize> Default for Initiator<K> {
    fn default() -> Self {
        Initiator {
            waiting: Vec::new(),
            fresh: Vec::new(),
            places: Vec::new(),
            grid: Grid::default(),
            problem: ScanProblem::default(),
            weights: Weights::default(),
            solver: GlobalNearestNeighbour::default(),
            is_paired: Vec::new(),
            pairs: Vec::new(),
        }
    }
}

impl<const K: usize> Initiator<K> {
    /// One more unused detection of the current scan.
    pub fn push(&mut self, point: Point<K>) {
        self.fresh.push(point);
    }

    /// Those that wait, of each sensor the longest waiting first.
    pub fn waiting(&self) -> &[Vec<Waiting<K>>] {
        &self.waiting
    }

    /// With these points waiting.
    pub fn with_waiting(waiting: Vec<Vec<Waiting<K>>>) -> Self {
        Initiator {
            waiting,
            ..Initiator::default()
        }
    }

    /// The pairs that the current scan of `sensor` completed.
    pub fn pairs(&self) -> &[Pair<K>] {
        &self.pairs
    }

    /// Ends the current scan of `sensor`: pairs its points with those that wait; the others wait from now on.
    ///
    /// # Errors
    /// When too many points are within reach of each other, or the watch says to stop.
    pub fn pair(&mut self, scan: &Scan, rule: &PairRule, watch: &Watch) -> Result<(), Halt> {
        let sensor = scan.sensor;
        if self.waiting.len() <= sensor {
            self.waiting.resize_with(sensor + 1, Vec::new);
        }
        self.build_problem(scan, rule, watch)?;
        self.weights.reset(&self.problem);
        let (solver, weights) = (&mut self.solver, &mut self.weights);
        self.problem
            .for_each_cluster_until(watch, |cluster| solver.associate(cluster, weights));
        bounds::go_on(watch)?;
        self.take_pairs(sensor, rule);
        let waiting = &mut self.waiting[sensor];
        let alone = self
            .fresh
            .iter()
            .zip(&self.is_paired)
            .filter(|(_, is_paired)| !**is_paired);
        waiting.extend(alone.map(|(&point, _)| Waiting { point, missed: 0 }));
        self.fresh.clear();
        Ok(())
    }

    /// Step 1: for each waiting point the fresh ones within its reach.
    fn build_problem(&mut self, scan: &Scan, rule: &PairRule, watch: &Watch) -> Result<(), Halt> {
        self.problem.begin(0, self.fresh.len());
        self.places.clear();
        self.places
            .extend(self.fresh.iter().map(|point| point.state.mean.data.0[0]));
        self.grid.rebuild(&self.places);
        let largest_noise = self
            .fresh
            .iter()
            .map(|point| noise(&point.state))
            .fold(0.0, f64::max);
        let latest_s = self.fresh.iter().map(Point::at_s).reduce(f64::max);
        for Waiting { point: first, .. } in &self.waiting[scan.sensor] {
            let Some(dt_s) = latest_s.map(|latest_s| latest_s - first.at_s()) else {
                break;
            };
            // Noise along Δ is at most that of all coordinates together.
            let farthest = rule.max_speed_mps * dt_s
                + (rule.gate_threshold * (noise(&first.state) + largest_noise)).sqrt();
            let (problem, fresh) = (&mut self.problem, &self.fresh);
            self.grid
                .near(&first.state.mean, [farthest; 2], None, |detection| {
                    let second = &fresh[detection as usize];
                    let squared_distance = squared_distance(first, second);
                    if squared_distance <= reach(first, second, rule).powi(2)
                        && rule.allows(first, second)
                    {
                        problem.push_edge(Edge {
                            detection,
                            squared_distance,
                            log_likelihood: -squared_distance,
                        });
                    }
                });
            self.problem.end_row(-farthest * farthest, 0.0);
            bounds::check_scan(self.problem.edges().len(), scan)?;
            if watch.stops_after(64) {
                return Err(Halt::Stopped);
            }
        }
        Ok(())
    }

    /// Step 3 for the pairs that step 2 chose; of the other first points only those go on waiting that may.
    fn take_pairs(&mut self, sensor: usize, rule: &PairRule) {
        self.is_paired.clear();
        self.is_paired.resize(self.fresh.len(), false);
        self.pairs.clear();
        let mut rows = self.problem.rows().iter();
        self.waiting[sensor].retain_mut(
            |Waiting {
                 point: first,
                 missed,
             }| {
                // A scan without an unused detection poses no problem.
                let pair = rows
                    .next()
                    .and_then(|row| row.edges().find(|&edge| self.weights.edges[edge] > 0.0));
                let Some(edge) = pair else {
                    *missed += 1;
                    return *missed < rule.max_wait_scans;
                };
                let index = self.problem.edges()[edge].detection as usize;
                let second = &self.fresh[index];
                self.is_paired[index] = true;
                let axes = (K / 2) as u32;
                let log_reach_volume =
                    log_unit_ball(axes) + f64::from(axes) * reach(first, second, rule).ln();
                let state = difference(first, second);
                self.pairs.push(Pair {
                    first: *first,
                    second: *second,
                    state,
                    log_reach_volume,
                    missed: *missed,
                });
                false
            },
        );
    }
}

impl PairRule {
    fn allows<const K: usize>(&self, first: &Point<K>, second: &Point<K>) -> bool {
        let is_later = second.at_s() > first.at_s();
        is_later && (!self.by_origin || first.origin.is_some() && first.origin == second.origin)
    }
}

/// Trace of R.
fn noise<const K: usize>(state: &GaussianState<K>) -> f64 {
    (0..K / 2).map(|axis| state.covariance[(axis, axis)]).sum()
}

/// |Δ|².
fn squared_distance<const K: usize>(first: &Point<K>, second: &Point<K>) -> f64 {
    (0..K / 2)
        .map(|axis| (second.state.mean[axis] - first.state.mean[axis]).powi(2))
        .sum()
}

fn reach<const K: usize>(first: &Point<K>, second: &Point<K>, rule: &PairRule) -> f64 {
    reach_m(first, second, rule.max_speed_mps, rule.gate_threshold).1
}

/// |Δ|, and `max_speed_mps` T + √(γ σ²).
pub(super) fn reach_m<const K: usize>(
    first: &Point<K>,
    second: &Point<K>,
    max_speed_mps: f64,
    gate_threshold: f64,
) -> (f64, f64) {
    let delta = second.state.mean - first.state.mean;
    let covariance = first.state.covariance + second.state.covariance;
    let mut variance = 0.0;
    for row in 0..K / 2 {
        for column in 0..K / 2 {
            variance += delta[row] * covariance[(row, column)] * delta[column];
        }
    }
    let squared = squared_distance(first, second);
    let along = if squared > 0.0 {
        variance / squared
    } else {
        0.0
    };
    let moved_m = max_speed_mps * (second.at_s() - first.at_s());
    (squared.sqrt(), moved_m + (gate_threshold * along).sqrt())
}

/// Step 3, without what the motion's noise adds.
fn difference<const K: usize>(first: &Point<K>, second: &Point<K>) -> GaussianState<K> {
    let (axes, dt_s) = (K / 2, second.at_s() - first.at_s());
    let mut state = second.state;
    for row in 0..axes {
        state.mean[row + axes] = (second.state.mean[row] - first.state.mean[row]) / dt_s;
        for column in 0..axes {
            let (before, now) = (
                first.state.covariance[(row, column)],
                second.state.covariance[(row, column)],
            );
            state.covariance[(row, column + axes)] = now / dt_s;
            state.covariance[(row + axes, column)] = now / dt_s;
            state.covariance[(row + axes, column + axes)] = (before + now) / (dt_s * dt_s);
        }
    }
    state
}

#[cfg(test)]
mod tests;
