//! What a job of groups reports, and its files.

use super::instants::Instant;
use super::run::Grouped;
use crate::correlation::grouping::Grouping;
use crate::correlation::grouping::fuzzy_c_means::History;
use crate::evaluation::grouping::GroupingCounts;
use crate::experiment::files::tables::{Table, number, optional};
use crate::experiment::job::Artifact;
use crate::experiment::limits::LimitsReport;
use crate::model::scan::Recording;
use serde::Serialize;

/// Instants that the report lists; all of them are in `groups.csv`.
const MAX_INSTANTS: usize = 1000;

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct GroupResult {
    grouping: GroupingSummary,
    /// Whether the numbers are within the limits, where the request has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub limits: Option<LimitsReport>,
}

/// What was put together, and how right it is where the detections say which target they came from. The groups themselves
/// are in the file `groups.csv`.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct GroupingSummary {
    /// The grouper.
    method: &'static str,
    counts: Counts,
    /// Share of the targets reported by two sensors or more whose reports were put together exactly, averaged over the instants
    /// that have such targets; null where origins are not known.
    accuracy: Option<f64>,
    /// Share of the pairs of reports in one group that are of one target.
    precision: Option<f64>,
    /// Share of the pairs of reports of one target that are in one group.
    recall: Option<f64>,
    /// Absent where the grouper does not search.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    search: Option<GroupingSearch>,
    /// The first thousand.
    instants: Vec<GroupingInstant>,
    instants_left_out: u64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = GroupingCounts))]
struct Counts {
    sensors: u64,
    instants: u64,
    reports: u64,
    groups: u64,
    /// Targets reported by two sensors or more, at each instant.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    duplicates: Option<u64>,
    /// Those whose reports were put together exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    exact: Option<u64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct GroupingSearch {
    mean_iterations: f64,
    max_iterations: u64,
    /// Mean over the instants of what is made small; null for a grouper that does not say.
    mean_cost: Option<f64>,
    /// Instants whose search did not come to rest.
    unconverged: u64,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct GroupingInstant {
    time_s: f64,
    reports: u64,
    groups: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    duplicates: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    exact: Option<u64>,
}

/// The result of the job.
pub fn report(grouped: &Grouped, recording: &Recording) -> GroupResult {
    let counts = grouped.counts.as_deref();
    let line = |(index, (instant, grouping)): (usize, &(Instant, Grouping))| {
        let of_instant = counts.map(|counts| counts[index]);
        GroupingInstant {
            time_s: instant.time_s,
            reports: instant.reports.len() as u64,
            groups: grouping.count() as u64,
            duplicates: of_instant.map(|counts| counts.duplicates),
            exact: of_instant.map(|counts| counts.exact),
        }
    };
    let mut lines: Vec<GroupingInstant> = grouped.instants.iter().enumerate().map(line).collect();
    let mut total = GroupingCounts::default();
    counts
        .unwrap_or_default()
        .iter()
        .for_each(|counts| total.add(counts));
    let accuracies: Vec<f64> = counts
        .unwrap_or_default()
        .iter()
        .filter_map(GroupingCounts::accuracy)
        .collect();
    let of_counts = |value: u64| counts.map(|_| value);
    let grouping = GroupingSummary {
        method: grouped.method,
        counts: Counts {
            sensors: recording.sensors.len() as u64,
            instants: lines.len() as u64,
            reports: lines.iter().map(|line| line.reports).sum(),
            groups: lines.iter().map(|line| line.groups).sum(),
            duplicates: of_counts(total.duplicates),
            exact: of_counts(total.exact),
        },
        accuracy: (!accuracies.is_empty())
            .then(|| accuracies.iter().sum::<f64>() / accuracies.len() as f64),
        precision: total.precision(),
        recall: total.recall(),
        search: search_of(grouped),
        instants_left_out: lines.len().saturating_sub(MAX_INSTANTS) as u64,
        instants: {
            lines.truncate(MAX_INSTANTS);
            lines
        },
    };
    GroupResult {
        grouping,
        limits: None,
    }
}

fn search_of(grouped: &Grouped) -> Option<GroupingSearch> {
    let iterations: Vec<u32> = grouped
        .instants
        .iter()
        .filter_map(|(_, grouping)| grouping.iterations)
        .collect();
    let costs: Vec<f64> = grouped
        .instants
        .iter()
        .filter_map(|(_, grouping)| grouping.cost)
        .collect();
    Some(GroupingSearch {
        mean_iterations: iterations
            .iter()
            .map(|&count| f64::from(count))
            .sum::<f64>()
            / iterations.len() as f64,
        max_iterations: iterations.iter().copied().max()?.into(),
        mean_cost: (!costs.is_empty()).then(|| costs.iter().sum::<f64>() / costs.len() as f64),
        unconverged: grouped
            .instants
            .iter()
            .filter(|(_, grouping)| !grouping.converged)
            .count() as u64,
    })
}

/// `groups.csv`, and `grouping_trace.csv` where a trace was asked for.
pub fn artifacts(grouped: &Grouped, recording: &Recording) -> Vec<Artifact> {
    let mut table = Table::new(
        false,
        &[
            "time_s",
            "group",
            "sensor_id",
            "detection_id",
            "membership",
            "truth_id",
        ],
    );
    let found = recording.index_detections();
    for (instant, grouping) in &grouped.instants {
        for (index, (&detection, report)) in
            instant.detections.iter().zip(&instant.reports).enumerate()
        {
            let origin = found.get(detection).and_then(|found| found.origin);
            let truth_id = origin.map(|origin| recording.targets[origin as usize].clone());
            table.row(&[
                number(instant.time_s),
                (grouping.group_of[index] + 1).to_string(),
                recording.sensors[report.sensor as usize].sensor_id.clone(),
                recording.detection_ids[detection].clone(),
                optional(grouping.memberships[index]),
                truth_id.unwrap_or_default(),
            ]);
        }
    }
    let mut files = vec![table.artifact("groups.csv")];
    files.extend(
        grouped
            .history
            .as_ref()
            .map(|history| trace(grouped, recording, history)),
    );
    files
}

/// J, V and U of every iteration, one number a row.
fn trace(grouped: &Grouped, recording: &Recording, history: &History) -> Artifact {
    let mut table = Table::new(
        false,
        &[
            "time_s",
            "iteration",
            "quantity",
            "group",
            "detection_id",
            "value",
        ],
    );
    for kept in &history.iterations {
        let (instant, _) = &grouped.instants[kept.snapshot as usize];
        let clusters = kept.centres.len() / grouped.columns.len();
        let mut row = |quantity: &str, group: Option<usize>, detection_id: &str, value: f64| {
            let group = group
                .map(|group| (group + 1).to_string())
                .unwrap_or_default();
            let (time_s, iteration) = (number(instant.time_s), kept.iteration.to_string());
            table.row(&[
                time_s,
                iteration,
                quantity.to_owned(),
                group,
                detection_id.to_owned(),
                number(value),
            ]);
        };
        row("cost", None, "", kept.cost);
        for (group, centre) in kept.centres.chunks_exact(grouped.columns.len()).enumerate() {
            for (column, &value) in grouped.columns.iter().zip(centre) {
                row(&format!("centre_{column}"), Some(group), "", value);
            }
        }
        for (memberships, &detection) in kept
            .memberships
            .chunks_exact(clusters)
            .zip(&instant.detections)
        {
            for (group, &membership) in memberships.iter().enumerate() {
                row(
                    "membership",
                    Some(group),
                    &recording.detection_ids[detection],
                    membership,
                );
            }
        }
    }
    table.artifact("grouping_trace.csv")
}
