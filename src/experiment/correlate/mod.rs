//! Puts the tracks of several sensors together: common times, a problem, a correlator, confirmation, and fusion.

mod checks;
mod decide;
mod nodes;
mod report;
mod requests;

pub(super) use checks::{check, estimate};
pub(super) use nodes::{Nodes, by_detections, drawn, of_sets};
pub(super) use report::{artifacts, report, tuple_lines};
pub use requests::CORRELATE;

use super::observer::{Observer, Step};
use super::plan::Plan;
use super::run::{Decided, RunError};
use crate::correlation::alignment::{self, Alignment, Assumed, Node};
use crate::correlation::cross_covariance::CrossTable;
use crate::correlation::estimates::Estimates;
use crate::correlation::evidence::Times;
use crate::correlation::fusion::{FUSIONS, system_tracks};
use crate::correlation::problem::CorrelationProblem;
use crate::correlation::statistic::{Correlation, Statistic, pairs_of};
use crate::correlation::{CORRELATORS, Solution};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::model::track::{Track, TrackSet};
use crate::model::truth::TruthSet;
use serde::Deserialize;
use serde_json::Value;
use std::sync::Arc;

/// Everything that a job found.
pub(super) struct Correlated {
    pub correlator: &'static str,
    /// The tracks of each sensor, as they came.
    pub nodes: Vec<Node>,
    pub correlation: Correlation,
    /// The last decision, and its problem.
    pub solution: Solution,
    pub problem: CorrelationProblem,
    pub confirm: Confirm,
    /// Tuples of two tracks or more that stand, with how often each was found.
    pub tuples: Vec<(Vec<u32>, u32)>,
    pub alone: Vec<u32>,
    /// What each track is really of.
    pub origins: Option<Vec<Option<u32>>>,
    /// What each origin is called.
    pub truth_ids: Vec<String>,
    /// Of the tuples, then of the tracks alone if they are kept.
    pub system_tracks: TrackSet,
    pub keeps_alone: bool,
    pub decided: Option<Decided>,
}

/// How often a tuple must be found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(super) struct Confirm {
    pub found: u32,
    pub of: u32,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct AlignmentSettings {
    reference: Option<String>,
    period_s: Option<f64>,
    process_noise_m2ps3: f64,
    max_gap_s: f64,
    sigma_m: Option<f64>,
    sigma_mps: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Cross {
    None,
    Coefficient { coefficient: f64 },
    Recursion { process_noise_m2ps3: f64 },
}

impl AlignmentSettings {
    fn assumed(&self) -> Option<Assumed> {
        self.sigma_m.map(|sigma_m| Assumed {
            sigma_m,
            sigma_mps: self.sigma_mps,
        })
    }
}

/// What a job of tracks works on.
pub(super) struct Material<'a> {
    pub nodes: Nodes,
    pub truth: Option<&'a TruthSet>,
    /// What the request says of sensors.
    pub sensors: &'a [SensorSettings],
}

/// The checked spec fits its tables; anything else is a fault of ours, reported like one of the request.
fn unusable(pointer: &str) -> RunError {
    RunError::Faults(vec![Fault::new(
        pointer,
        "malformed",
        "the settings cannot be used",
    )])
}

fn read<'a, T: Deserialize<'a>>(spec: &'a Value, name: &str) -> Result<T, RunError> {
    T::deserialize(&spec[name]).map_err(|_| unusable(&format!("/{name}")))
}

pub(super) fn correlate(
    plan: &Plan,
    material: Material,
    warnings: &mut Vec<String>,
    observer: &mut dyn Observer,
) -> Result<Correlated, RunError> {
    let spec = &plan.spec;
    let settings: AlignmentSettings = read(spec, "alignment")?;
    let (statistic, confirm): (Statistic, Confirm) =
        (read(spec, "statistic")?, read(spec, "confirm")?);
    let Material {
        nodes:
            Nodes {
                nodes,
                mut origins,
                mut truth_ids,
            },
        truth,
        sensors,
    } = material;
    nodes::check(
        &nodes,
        spec.get("sets").is_some(),
        settings.assumed(),
        warnings,
    )?;
    if let Some(truth) = truth.filter(|_| origins.is_none()) {
        origins = Some(nodes::by_truth(
            &nodes,
            truth,
            spec["truth_gate_m"].as_f64().unwrap_or(100.0),
        ));
        truth_ids = truth
            .targets()
            .iter()
            .map(|target| target.truth_id.clone())
            .collect();
    }
    let estimates = aligned(&nodes, &settings, spec.get("sets").is_some(), warnings)?;
    if confirm.of as usize > estimates.times() {
        return Err(vec![checks::too_few_times(
            confirm.of as usize,
            estimates.times(),
        )]
        .into());
    }
    let place = if spec.get("sets").is_some() {
        "/sets"
    } else {
        "/input"
    };
    let pairs = pairs_of(&estimates, &statistic).map_err(|detail| {
        vec![
            Fault::new(place, "too_large", detail)
                .allowing("fewer tracks, fewer common times, or a smaller gate"),
        ]
    })?;
    let cross = cross_of(
        read(spec, "cross_covariance")?,
        &estimates,
        &nodes,
        &pairs,
        warnings,
    )?;
    let p_d = p_d_of(&statistic, &estimates.sensor_ids, sensors);
    let correlation = Correlation {
        statistic,
        estimates: Arc::new(estimates),
        cross: cross.map(Arc::new),
        pairs,
        p_d,
    };
    warn(&correlation, spec, warnings);
    let entry = CORRELATORS
        .iter()
        .find(|entry| spec["correlator"]["method"] == entry.name)
        .ok_or_else(|| unusable("/correlator"))?;
    let mut correlator =
        (entry.build)(&spec["correlator"], plan.stream()).map_err(|_| unusable("/correlator"))?;
    let decisions = decide::decide(&correlation, confirm, &mut *correlator, observer)?;
    let fusion = FUSIONS
        .iter()
        .find(|entry| spec["fusion"]["method"] == entry.name)
        .ok_or_else(|| unusable("/fusion"))?;
    let fusion = (fusion.build)(&spec["fusion"]).map_err(|_| unusable("/fusion"))?;
    let keeps_alone = spec["keep_unassociated"] == true;
    let kept = decisions
        .alone
        .iter()
        .filter(|_| keeps_alone)
        .map(|&track| vec![track]);
    let sources: Vec<Vec<u32>> = decisions
        .tuples
        .iter()
        .map(|(tuple, _)| tuple.clone())
        .chain(kept)
        .collect();
    let system_tracks = system_tracks(
        &correlation.evidence(correlation.estimates.times()),
        &sources,
        &*fusion,
    );
    told(observer, Step::Evaluate, 1, 1)?;
    Ok(Correlated {
        correlator: entry.name,
        nodes,
        solution: decisions.solution,
        problem: decisions.problem,
        confirm,
        tuples: decisions.tuples,
        alone: decisions.alone,
        origins,
        truth_ids,
        system_tracks,
        keeps_alone,
        decided: decisions.decided.filter(|_| plan.is_timed),
        correlation,
    })
}

fn told(observer: &mut dyn Observer, step: Step, done: u64, total: u64) -> Result<(), RunError> {
    if observer.progress(step, done, total).is_break() {
        Err(RunError::Stopped)
    } else {
        Ok(())
    }
}

/// All tracks at the common times.
fn aligned(
    nodes: &[Node],
    settings: &AlignmentSettings,
    is_of_sets: bool,
    warnings: &mut Vec<String>,
) -> Result<Estimates, RunError> {
    let times_s = common_times(nodes, settings)?;
    let tracks: usize = nodes.iter().map(|node| node.tracks.tracks.len()).sum();
    let place = if is_of_sets { "/sets" } else { "/input" };
    if tracks * times_s.len() > checks::MAX_ESTIMATES {
        let points = (tracks * times_s.len()) as f64;
        return Err(vec![checks::too_many_estimates(place, points, points * 2e-6)].into());
    }
    let alignment = Alignment {
        process_noise_m2ps3: settings.process_noise_m2ps3,
        max_gap_s: settings.max_gap_s,
        assumed: settings.assumed(),
    };
    let (estimates, left_out) = alignment::align(nodes, &times_s, &alignment);
    if estimates.times() == 0 {
        let detail = "there is no common time at which two sensors have a track";
        return Err(vec![
            Fault::new(place, "disjoint", detail)
                .allowing("tracks that overlap in time, or a longer alignment/max_gap_s"),
        ]
        .into());
    }
    if left_out > 0 {
        warnings.push(format!(
            "{left_out} estimates are left out: their covariance is not positive definite"
        ));
    }
    if !estimates.has_velocity {
        warnings.push(
            "not all tracks have velocities with covariances: positions alone are compared, at the times of the tracks' own points"
                .to_owned(),
        );
    }
    Ok(estimates)
}

fn common_times(nodes: &[Node], settings: &AlignmentSettings) -> Result<Vec<f64>, RunError> {
    if let Some(period_s) = settings.period_s {
        let times_s: Vec<f64> = nodes
            .iter()
            .flat_map(|node| alignment::times_of(&node.tracks))
            .collect();
        let first_s = times_s.iter().copied().fold(f64::INFINITY, f64::min);
        let last_s = times_s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let count = ((last_s - first_s) / period_s + 1e-9).floor().max(0.0);
        if count > checks::MAX_ESTIMATES as f64 {
            let detail = format!("{last_s} s − {first_s} s make {count:.0} common times");
            let fault = Fault::new("/alignment/period_s", "too_large", detail);
            return Err(vec![fault.allowing(format!(
                "at most {} tracks × common times",
                checks::MAX_ESTIMATES
            ))]
            .into());
        }
        return Ok((0..=count as u64)
            .map(|number| first_s + number as f64 * period_s)
            .collect());
    }
    let reference = match &settings.reference {
        None => nodes.first(),
        Some(name) => nodes.iter().find(|node| node.sensor_id == *name),
    };
    let reference = reference.ok_or_else(|| {
        let names: Vec<&str> = nodes.iter().map(|node| node.sensor_id.as_str()).collect();
        vec![
            Fault::new(
                "/alignment/reference",
                "unknown_value",
                "there is no sensor of this name",
            )
            .allowing(names.join(", ")),
        ]
    })?;
    Ok(alignment::times_of(&reference.tracks))
}

/// The cross-covariances of the pairs that may be linked.
fn cross_of(
    cross: Cross,
    estimates: &Estimates,
    nodes: &[Node],
    pairs: &[(u32, u32)],
    warnings: &mut Vec<String>,
) -> Result<Option<CrossTable>, RunError> {
    match cross {
        Cross::None => Ok(None),
        Cross::Coefficient { coefficient } => {
            warnings.push(format!(
                "the errors of all tracks are assumed to be correlated with ρ = {coefficient}"
            ));
            Ok(Some(CrossTable::with_coefficient(
                estimates,
                pairs,
                coefficient,
            )))
        }
        Cross::Recursion {
            process_noise_m2ps3,
        } => {
            let is_known = |node: &Node| {
                let points = node.tracks.tracks.iter().flat_map(|track| &track.points);
                points
                    .filter_map(|point| point.estimate.plane())
                    .all(|plane| plane.has_velocity && plane.covariance.is_some())
            };
            if let Some(node) = nodes.iter().find(|node| !is_known(node)) {
                let detail = format!(
                    "the recursion needs the velocity and the covariance of every point, which '{}' lacks",
                    node.sensor_id
                );
                return Err(vec![
                    Fault::new("/cross_covariance/kind", "unsupported", detail)
                        .allowing("none, coefficient"),
                ]
                .into());
            }
            let tracks: Vec<&Track> = nodes.iter().flat_map(|node| &node.tracks.tracks).collect();
            Ok(Some(CrossTable::by_recursion(
                estimates,
                &tracks,
                pairs,
                process_noise_m2ps3,
            )))
        }
    }
}

/// What the settings of each sensor say, else the statistic; a sensor is never certain.
fn p_d_of(statistic: &Statistic, sensor_ids: &[String], sensors: &[SensorSettings]) -> Vec<f64> {
    let Statistic::LikelihoodRatio { p_d, .. } = *statistic else {
        return vec![0.9; sensor_ids.len()];
    };
    let of_sensor = |name: &String| {
        sensors
            .iter()
            .find(|sensor| sensor.sensor_id == *name)
            .and_then(|sensor| sensor.p_d)
    };
    sensor_ids
        .iter()
        .map(|name| of_sensor(name).unwrap_or(p_d).min(0.999))
        .collect()
}

/// What a reader must know of the statistic.
fn warn(correlation: &Correlation, spec: &Value, warnings: &mut Vec<String>) {
    let (statistic, estimates) = (&correlation.statistic, &correlation.estimates);
    let correlated = spec
        .pointer("/input/tracks/correlation")
        .and_then(Value::as_f64);
    if statistic.alpha().is_some()
        && statistic.times() == Times::All
        && estimates.times() > 1
        && correlated != Some(0.0)
    {
        warnings.push(format!(
            "λ is summed over up to {} times: it is chi-square only where a track's errors are white in time, and those of filtered \
             tracks are not, so that more than α of the true pairs are taken apart; statistic.k 'latest' tests one time",
            estimates.times()
        ));
    }
    if matches!(statistic, Statistic::Chain { .. }) && estimates.tracks_of.len() > 2 {
        warnings.push(
            "the chain statistic adds neighbouring sensors only: the problem is one two-dimensional assignment, whose optimum the \
             correlator 'exact' finds at any size"
                .to_owned(),
        );
    }
    if spec["correlator"]["method"] == "modified" && correlation.cross.is_none() {
        warnings.push(
            "cross_covariance is none: the correlator 'modified' does what 'weighted' does"
                .to_owned(),
        );
    }
    if let Some((target_density, false_density)) = correlation.densities() {
        warnings
            .push(format!("likelihood ratio: β_T = {target_density:.3e} and β_F = {false_density:.3e} per unit of the space of states"));
    }
}
