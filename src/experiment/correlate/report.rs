//! What a job that correlates tracks reports, and its files.

use super::run::Correlated;
use crate::correlation::alignment::Node;
use crate::correlation::evidence::Evidence;
use crate::correlation::statistic::p_value;
use crate::evaluation::grouping::{GroupedReport, GroupingCounts};
use crate::experiment::files::tables::{Table, number, optional};
use crate::experiment::job::Artifact;
use crate::experiment::limits::LimitsReport;
use crate::formats;
use crate::model::dataset::Dataset;
use crate::model::track::{Track, TrackPoint, TrackSet};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Error;

/// Tuples and lone tracks that the report lists; all of them are in `tuples.csv`.
const MAX_LINES: usize = 1000;

/// Which tracks are of one target. The fused tracks are in the file `system_tracks.csv`, all tuples in `tuples.csv`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct CorrelateResult {
    correlator: &'static str,
    /// `chain`, `all_pairs`, `fused` or `likelihood_ratio`.
    statistic: &'static str,
    /// In this order tracks stand in a tuple.
    sensors: Vec<CorrelatedSensor>,
    counts: CorrelationCounts,
    /// J of the last decision.
    cost: f64,
    /// No way to put the tracks together costs less; null where the correlator does not know.
    dual_bound: Option<f64>,
    /// How far J may be above the least cost there is, as a share of the bound; null without one.
    gap: Option<f64>,
    /// Absent where the correlator does not search.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    search: Option<CorrelationSearch>,
    confirm: CorrelationConfirmation,
    /// Tuples of two tracks or more; the first thousand.
    tuples: Vec<CorrelationTuple>,
    tuples_left_out: u64,
    /// Tracks that are alone; the first thousand.
    unassociated: Vec<UnassociatedTrack>,
    unassociated_left_out: u64,
    /// Null where nobody knows what the tracks are of.
    truth: Option<CorrelationTruth>,
    /// Whether the numbers are within the limits, where the request has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub limits: Option<LimitsReport>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct CorrelatedSensor {
    sensor_id: String,
    tracks: u64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct CorrelationCounts {
    sensors: u64,
    tracks: u64,
    common_times: u64,
    /// Numbers of a state that are compared.
    dimensions: u64,
    /// Pairs that may be of one target.
    links: u64,
    tuples: u64,
    unassociated: u64,
    system_tracks: u64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct CorrelationSearch {
    /// The cost of the best solution of each generation or iteration.
    best: Vec<f64>,
    /// The mean cost of each.
    mean: Vec<f64>,
    generations: u64,
    /// Solutions whose cost was computed.
    evaluations: u64,
    /// Why it ended.
    stop: &'static str,
}

/// A tuple stands when it was found in so many of so many decisions at successive times.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct CorrelationConfirmation {
    found: u64,
    of: u64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct CorrelationTuple {
    /// The system track made of it.
    system_track_id: String,
    /// The track of each sensor; null where the sensor has none.
    tracks: Vec<Option<String>>,
    /// Null for a tuple that could not be made at the last time.
    cost: Option<f64>,
    /// The sum of squared distances over neighbouring sensors; null where two of them have no common time.
    b: Option<f64>,
    /// Squared distances from the information-weighted mean.
    statistic: f64,
    degrees_of_freedom: u64,
    /// Probability that tracks of one target are at least so far apart; null without common times.
    p_value: Option<f64>,
    /// Decisions that found it.
    found: u64,
    /// The target of most of its tracks.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    truth_id: Option<String>,
    /// Whether its tracks are all the tracks of one target and nothing else; absent where nobody knows.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    right: Option<bool>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct UnassociatedTrack {
    sensor_id: String,
    track_id: String,
}

/// Against what the tracks are really of.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct CorrelationTruth {
    /// Targets of which two sensors or more have tracks.
    tuples: u64,
    /// Those whose tracks, all of them and nothing else, are one tuple.
    tuples_right: u64,
    share_right: Option<f64>,
    pairwise_precision: Option<f64>,
    pairwise_recall: Option<f64>,
    /// Tracks of no target.
    false_tracks: u64,
}

/// The report; `tuples` are those of [`tuple_lines`].
pub fn report(correlated: &Correlated, mut tuples: Vec<CorrelationTuple>) -> CorrelateResult {
    let (estimates, solution) = (&correlated.correlation.estimates, &correlated.solution);
    let sensors = estimates.sensor_ids.iter().zip(&estimates.tracks_of);
    let sensors_of_tracks = estimates.sensors_of_tracks();
    let problem = &correlated.problem;
    let links = (0..problem.tracks() as u32)
        .map(|track| problem.links(track).len())
        .sum::<usize>()
        / 2;
    let name = |&track: &u32| UnassociatedTrack {
        sensor_id: estimates.sensor_ids[sensors_of_tracks[track as usize]].clone(),
        track_id: estimates.track_ids[track as usize].clone(),
    };
    CorrelateResult {
        limits: None,
        correlator: correlated.correlator,
        statistic: correlated.correlation.statistic.name(),
        sensors: sensors
            .map(|(sensor_id, &tracks)| CorrelatedSensor {
                sensor_id: sensor_id.clone(),
                tracks: tracks as u64,
            })
            .collect(),
        counts: CorrelationCounts {
            sensors: estimates.tracks_of.len() as u64,
            tracks: estimates.tracks() as u64,
            common_times: estimates.times() as u64,
            dimensions: estimates.dimensions() as u64,
            links: links as u64,
            tuples: tuples.len() as u64,
            unassociated: correlated.alone.len() as u64,
            system_tracks: correlated.system_tracks.tracks.len() as u64,
        },
        cost: solution.cost,
        dual_bound: solution.dual_bound,
        gap: solution.dual_bound.map(|bound| gap(solution.cost, bound)),
        search: solution.search.as_ref().map(|search| CorrelationSearch {
            best: search.best.clone(),
            mean: search.mean.clone(),
            generations: search.best.len() as u64,
            evaluations: search.evaluations,
            stop: search.stop,
        }),
        confirm: CorrelationConfirmation {
            found: correlated.confirm.found.into(),
            of: correlated.confirm.of.into(),
        },
        tuples_left_out: tuples.len().saturating_sub(MAX_LINES) as u64,
        unassociated: correlated.alone.iter().take(MAX_LINES).map(name).collect(),
        unassociated_left_out: correlated.alone.len().saturating_sub(MAX_LINES) as u64,
        truth: truth(correlated),
        tuples: {
            tuples.truncate(MAX_LINES);
            tuples
        },
    }
}

/// How far a cost is above its bound, as a share of the bound; what rounding leaves is none.
fn gap(cost: f64, bound: f64) -> f64 {
    let gap = (cost - bound) / bound.abs().max(1e-12);
    if gap.abs() < 1e-12 { 0.0 } else { gap }
}

/// Every tuple that stands.
pub fn tuple_lines(correlated: &Correlated) -> Vec<CorrelationTuple> {
    let correlation = &correlated.correlation;
    let evidence = correlation.evidence(correlation.estimates.times());
    let sensors = correlation.estimates.sensors_of_tracks();
    let line = |(index, (tuple, found)): (usize, &(Vec<u32>, u32))| {
        let spread = evidence.spread(tuple);
        let mut tracks = vec![None; correlation.estimates.tracks_of.len()];
        tuple.iter().for_each(|&track| {
            tracks[sensors[track as usize]] =
                Some(correlation.estimates.track_ids[track as usize].clone())
        });
        CorrelationTuple {
            system_track_id: (index + 1).to_string(),
            tracks,
            cost: correlated.problem.cost(tuple),
            b: chain(&evidence, tuple),
            statistic: spread.q,
            degrees_of_freedom: spread.degrees_of_freedom as u64,
            p_value: p_value(&spread),
            found: (*found).into(),
            truth_id: truth_of(correlated, tuple),
            right: is_right(correlated, tuple),
        }
    };
    correlated.tuples.iter().enumerate().map(line).collect()
}

/// Whether these are all the tracks of one target, and nothing else.
fn is_right(correlated: &Correlated, tuple: &[u32]) -> Option<bool> {
    let origins = correlated.origins.as_ref()?;
    let Some(target) = origins[tuple[0] as usize] else {
        return Some(false);
    };
    let of_target = origins
        .iter()
        .filter(|origin| **origin == Some(target))
        .count();
    Some(
        of_target == tuple.len()
            && tuple
                .iter()
                .all(|&track| origins[track as usize] == Some(target)),
    )
}

/// b: Σ λ over neighbours.
fn chain(evidence: &Evidence, tuple: &[u32]) -> Option<f64> {
    tuple
        .windows(2)
        .map(|pair| evidence.pair(pair[0], pair[1]).map(|pair| pair.lambda))
        .sum()
}

/// The target of most of the tracks; the first of equals.
fn truth_of(correlated: &Correlated, tuple: &[u32]) -> Option<String> {
    let origins: Vec<u32> = tuple
        .iter()
        .filter_map(|&track| correlated.origins.as_ref()?[track as usize])
        .collect();
    let count = |origin: &u32| origins.iter().filter(|other| *other == origin).count();
    let most = origins.iter().map(count).max()?;
    let origin = origins
        .iter()
        .filter(|origin| count(origin) == most)
        .min()?;
    correlated.truth_ids.get(*origin as usize).cloned()
}

fn truth(correlated: &Correlated) -> Option<CorrelationTruth> {
    let origins = correlated.origins.as_ref()?;
    let sensors = correlated.correlation.estimates.sensors_of_tracks();
    let mut group_of = vec![0; origins.len()];
    let groups = correlated
        .tuples
        .iter()
        .map(|(tuple, _)| tuple.as_slice())
        .chain(correlated.alone.chunks(1));
    groups.enumerate().for_each(|(group, tuple)| {
        tuple
            .iter()
            .for_each(|&track| group_of[track as usize] = group)
    });
    let report = |(track, &origin): (usize, &Option<u32>)| GroupedReport {
        sensor: sensors[track] as u32,
        origin,
        group: group_of[track],
    };
    let reports: Vec<GroupedReport> = origins.iter().enumerate().map(report).collect();
    let counts = GroupingCounts::from_reports(&reports);
    Some(CorrelationTruth {
        tuples: counts.duplicates,
        tuples_right: counts.exact,
        share_right: counts.accuracy(),
        pairwise_precision: counts.precision(),
        pairwise_recall: counts.recall(),
        false_tracks: origins.iter().filter(|origin| origin.is_none()).count() as u64,
    })
}

/// `tuples.csv`, `system_tracks.csv` and `local_tracks.csv`.
pub fn artifacts(
    correlated: &Correlated,
    tuples: &[CorrelationTuple],
) -> Result<Vec<Artifact>, Error> {
    let mut bytes = Vec::new();
    let dataset = Dataset::Tracks(correlated.system_tracks.clone());
    formats::write_csv(&dataset, &mut bytes)?;
    let tracks = Artifact {
        name: "system_tracks.csv",
        media_type: "text/csv",
        bytes,
        dataset: Some(dataset.summary()),
        sensors: Vec::new(),
    };
    Ok(vec![
        tracks,
        table(correlated, tuples),
        local_tracks(&correlated.nodes)?,
    ])
}

/// The tracks that were put together, with all that they say of their targets: a table of tracks, of which the points of each sensor
/// are a set for another job. Tracks of two sensors may have one name, so rows are in order of time within a name.
fn local_tracks(nodes: &[Node]) -> Result<Artifact, Error> {
    let mut of_name: BTreeMap<&str, Vec<TrackPoint>> = BTreeMap::new();
    for (sensor, node) in nodes.iter().enumerate() {
        for track in &node.tracks.tracks {
            let bare = track.points.iter().map(|point| TrackPoint {
                sensor: Some(sensor as u32),
                known_at_s: None,
                existence: None,
                mode_row: None,
                first_candidate: 0,
                candidates: 0,
                ..point.clone()
            });
            of_name.entry(&track.track_id).or_default().extend(bare);
        }
    }
    let track = |(name, mut points): (&str, Vec<TrackPoint>)| {
        points.sort_by(|left, right| left.time_s.total_cmp(&right.time_s));
        Track {
            track_id: name.to_owned(),
            points,
        }
    };
    let sensor_ids = nodes.iter().map(|node| node.sensor_id.clone()).collect();
    let set = TrackSet {
        frame: nodes.first().and_then(|node| node.tracks.frame),
        tracks: of_name.into_iter().map(track).collect(),
        sensor_ids,
        ..TrackSet::default()
    };
    let mut bytes = Vec::new();
    formats::write_csv(&Dataset::Tracks(set), &mut bytes)?;
    Ok(Artifact::file("local_tracks.csv", "text/csv", bytes))
}

/// A row a tuple, the tracks that are alone below them, with the track of each sensor.
fn table(correlated: &Correlated, tuples: &[CorrelationTuple]) -> Artifact {
    let estimates = &correlated.correlation.estimates;
    let mut table = Table::new(
        false,
        &[
            "system_track_id",
            "cost",
            "b",
            "statistic",
            "degrees_of_freedom",
            "p_value",
            "found",
            "truth_id",
        ],
    );
    table.columns(
        estimates
            .sensor_ids
            .iter()
            .map(|sensor_id| format!("track_of_{sensor_id}")),
    );
    for line in tuples {
        let mut cells = vec![
            line.system_track_id.clone(),
            optional(line.cost),
            optional(line.b),
            number(line.statistic),
            line.degrees_of_freedom.to_string(),
            optional(line.p_value),
            line.found.to_string(),
            line.truth_id.clone().unwrap_or_default(),
        ];
        cells.extend(
            line.tracks
                .iter()
                .map(|track| track.clone().unwrap_or_default()),
        );
        table.row(&cells);
    }
    let sensors = estimates.sensors_of_tracks();
    for (index, &track) in correlated.alone.iter().enumerate() {
        let id = if correlated.keeps_alone {
            (correlated.tuples.len() + index + 1).to_string()
        } else {
            String::new()
        };
        let truth_id = truth_of(correlated, &[track]).unwrap_or_default();
        let mut cells = vec![
            id,
            "0".to_owned(),
            String::new(),
            String::new(),
            "0".to_owned(),
            String::new(),
            String::new(),
            truth_id,
        ];
        cells.extend((0..estimates.tracks_of.len()).map(|sensor| {
            if sensor == sensors[track as usize] {
                estimates.track_ids[track as usize].clone()
            } else {
                String::new()
            }
        }));
        table.row(&cells);
    }
    table.artifact("tuples.csv")
}
