//! Puts the tracks of several sensors together: common times, a problem, a correlator, confirmation, and fusion.

use super::align::align_tracks;
use super::check::too_few_times;
use super::decide::decide;
use super::nodes::{self, Nodes};
use super::spec::{Confirm, CrossSpec, Spec};
use crate::correlation::Solution;
use crate::correlation::alignment::Node;
use crate::correlation::cross_covariance::CrossTable;
use crate::correlation::estimates::Estimates;
use crate::correlation::evidence::Times;
use crate::correlation::fusion::system_tracks;
use crate::correlation::problem::CorrelationProblem;
use crate::correlation::statistic::{Correlation, Statistic, pairs_of};
use crate::experiment::input::JobData;
use crate::experiment::job::{AssociationTime, RunError, RunSettings};
use crate::experiment::observer::{Observer, Step, report_progress};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::model::track::{Track, TrackSet};
use std::sync::Arc;

/// Everything that a job found.
pub struct Correlated {
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
    pub association_time: Option<AssociationTime>,
}

/// Puts the tracks of the nodes together.
///
/// # Errors
/// [`RunError::Stopped`]; tracks that cannot be compared, or not by these settings.
pub fn correlate(
    spec: &Spec,
    nodes: Nodes,
    data: &mut JobData,
    settings: RunSettings,
    observer: &mut dyn Observer,
) -> Result<Correlated, RunError> {
    let (confirm, warnings) = (spec.confirm, &mut data.warnings);
    nodes::check(&nodes.nodes, spec, warnings)?;
    let nodes = match &data.truth {
        Some(truth) if nodes.origins.is_none() => nodes.by_truth(truth, spec.truth_gate_m),
        _ => nodes,
    };
    let sensors = if data.sensors.is_empty() {
        &spec.sensors
    } else {
        &data.sensors
    };
    let correlation = problem_of(spec, &nodes.nodes, sensors, warnings)?;
    warn(&correlation, spec, warnings);
    let mut correlator = spec.correlator.build(settings.seed);
    let decisions = decide(&correlation, confirm, &mut *correlator, observer)?;
    let tuples = decisions.tuples.iter().map(|(tuple, _)| tuple.clone());
    let mut sources: Vec<Vec<u32>> = tuples.collect();
    if spec.keep_unassociated {
        sources.extend(decisions.alone.iter().map(|&track| vec![track]));
    }
    let evidence = correlation.evidence(correlation.estimates.times());
    let system_tracks = TrackSet {
        frame: nodes.nodes.first().and_then(|node| node.tracks.frame),
        ..system_tracks(&evidence, &sources, &*spec.fusion.build())
    };
    report_progress(observer, Step::Evaluate, 1, 1)?;
    let association_time = decisions.association_time;
    Ok(Correlated {
        correlator: spec.correlator.name(),
        nodes: nodes.nodes,
        solution: decisions.solution,
        problem: decisions.problem,
        confirm,
        tuples: decisions.tuples,
        alone: decisions.alone,
        origins: nodes.origins,
        truth_ids: nodes.truth_ids,
        system_tracks,
        keeps_alone: spec.keep_unassociated,
        association_time: association_time.filter(|_| settings.time_association),
        correlation,
    })
}

/// The tracks at common times, and the pairs of them that may be of one target.
fn problem_of(
    spec: &Spec,
    nodes: &[Node],
    sensors: &[SensorSettings],
    warnings: &mut Vec<String>,
) -> Result<Correlation, RunError> {
    let statistic = spec.statistic;
    let estimates = align_tracks(nodes, spec, warnings)?;
    let (of, times) = (spec.confirm.of as usize, estimates.times());
    if of > times {
        return Err(too_few_times(of, times).into());
    }
    let pairs = pairs_of(&estimates, &statistic).map_err(|detail| {
        Fault::new(spec.place(), "too_large", detail)
            .allowing("fewer tracks, fewer common times, or a smaller gate")
    })?;
    let cross = cross_covariances(spec.cross_covariance, &estimates, nodes, &pairs, warnings)?;
    let p_d = p_d_of(&statistic, &estimates.sensor_ids, sensors);
    Ok(Correlation {
        statistic,
        estimates: Arc::new(estimates),
        cross: cross.map(Arc::new),
        pairs,
        p_d,
    })
}

/// The cross-covariances of the pairs that may be linked.
fn cross_covariances(
    cross: CrossSpec,
    estimates: &Estimates,
    nodes: &[Node],
    pairs: &[(u32, u32)],
    warnings: &mut Vec<String>,
) -> Result<Option<CrossTable>, RunError> {
    match cross {
        CrossSpec::None => Ok(None),
        CrossSpec::Coefficient { coefficient } => {
            warnings.push(format!(
                "the errors of all tracks are assumed to be correlated with ρ = {coefficient}"
            ));
            Ok(Some(CrossTable::with_coefficient(
                estimates,
                pairs,
                coefficient,
            )))
        }
        CrossSpec::Recursion {
            process_noise_m2ps3,
        } => {
            let is_known = |node: &Node| {
                let points = node.tracks.tracks.iter().flat_map(|track| &track.points);
                points
                    .map(|point| &point.estimate)
                    .all(|said| said.velocity.is_some() && said.covariance.is_some())
            };
            if let Some(node) = nodes.iter().find(|node| !is_known(node)) {
                let detail = format!(
                    "the recursion needs the velocity and the covariance of every point, which '{}' lacks",
                    node.sensor_id
                );
                return Err(Fault::new("/cross_covariance/kind", "unsupported", detail)
                    .allowing("none, coefficient")
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
fn warn(correlation: &Correlation, spec: &Spec, warnings: &mut Vec<String>) {
    let (statistic, estimates) = (&correlation.statistic, &correlation.estimates);
    let drawn = spec.input.tracks.as_ref();
    let correlated = drawn.map(|tracks| tracks.correlation);
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
    if spec.correlator.name() == "modified" && correlation.cross.is_none() {
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
