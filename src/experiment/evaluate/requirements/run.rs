//! Holds tracks against requirements: the part of the report, the file of faults, and the checks that a build server reads.

use super::RequirementsSpec;
use crate::evaluation::credit::Credit;
use crate::evaluation::surveillance::{Assessment, Finding, PairedUpdates, assess};
use crate::experiment::evaluate::progress::MetricProgress;
use crate::experiment::evaluate::within::Seen;
use crate::experiment::files::tables::{Table, number, optional};
use crate::experiment::job::{Artifact, RunError};
use crate::experiment::limits::{HeldAgainst, Limit, LimitCheck};
use crate::experiment::observer::Observer;
use crate::model::fault::Fault;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use serde::Serialize;
use std::collections::BTreeMap;

const FILE: &str = "requirement_events.csv";

const COLUMNS: [&str; 10] = [
    "time_s",
    "truth_id",
    "track_id",
    "sector_id",
    "requirement",
    "fault",
    "size",
    "unit",
    "x_m",
    "y_m",
];

/// The part `requirements` of a result.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct RequirementsReport {
    /// Within this distance an update may be of a target.
    pub gate_m: f64,
    /// How updates found their targets.
    pub updates: PairedUpdates,
    /// Faults in `requirement_events.csv`.
    pub events: usize,
    /// More that are not in it.
    pub events_left_out: u64,
    /// Sector by sector.
    pub findings: Vec<Finding>,
    /// The same by sector and name, for limits and outcomes of campaigns; a second one of a name is called `detection_2`.
    pub values: BTreeMap<String, BTreeMap<String, RequirementValue>>,
}

/// What one requirement says in one sector.
#[derive(Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct RequirementValue {
    /// Null where nothing could be judged.
    pub value: Option<f64>,
    /// Why it is null.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub reason: Option<String>,
    /// Null without a threshold; what has no value is not met.
    pub met: Option<bool>,
}

fn values(findings: &[Finding]) -> BTreeMap<String, BTreeMap<String, RequirementValue>> {
    let mut values: BTreeMap<String, BTreeMap<String, RequirementValue>> = BTreeMap::new();
    for finding in findings {
        let of_sector = values.entry(finding.sector_id.clone()).or_default();
        let mut name = finding.requirement.clone();
        for number in 2.. {
            if !of_sector.contains_key(&name) {
                break;
            }
            name = format!("{}_{number}", finding.requirement);
        }
        let is_held = finding.verdict == Some("pass");
        let value = RequirementValue {
            value: finding.value,
            reason: finding.value.is_none().then(|| why_null(finding)),
            met: finding.comparison.map(|_| is_held),
        };
        of_sector.insert(name, value);
    }
    values
}

fn why_null(finding: &Finding) -> String {
    if finding.not_judged.is_empty() {
        return "nothing was due".to_owned();
    }
    let counts = finding.not_judged.iter();
    let told: Vec<String> = counts
        .map(|(reason, count)| format!("{count} {reason}"))
        .collect();
    format!("nothing could be judged: {}", told.join(", "))
}

/// What a job says of requirements.
pub struct Held {
    pub report: RequirementsReport,
    pub checks: Vec<LimitCheck>,
    /// Where files are wanted.
    pub file: Option<Artifact>,
}

/// What is held against requirements.
pub struct HeldSubject<'d> {
    pub truth: &'d TruthSet,
    pub tracks: &'d TrackSet,
    pub recording: Option<Seen<'d>>,
}

/// Judges tracks by the requirements of a request; `gate_m` is that of the comparison.
///
/// # Errors
/// A stop, directions, and sectors that the truth has no plane for.
pub fn hold(
    spec: &RequirementsSpec,
    (gate_m, credit): (f64, Credit),
    subject: &HeldSubject,
    wants_files: bool,
    observer: &mut dyn Observer,
) -> Result<Held, RunError> {
    let (truth, tracks) = (subject.truth, subject.tracks);
    if !truth.space().has_places() || !tracks.space.has_places() {
        let detail = "directions have no positions to hold against requirements";
        let fault = Fault::new("/requirements", "unsupported", detail);
        return Err(fault.allowing("truth and tracks with places").into());
    }
    let settings = spec.settings((truth, subject.recording), (gate_m, credit))?;
    let mut progress = MetricProgress::new(observer, 1);
    let assessment = progress.watching(|watch| assess(truth, tracks, &settings, watch))?;
    Ok(Held {
        file: wants_files.then(|| write(&assessment, truth, tracks)),
        checks: assessment.findings.iter().filter_map(check_of).collect(),
        report: RequirementsReport {
            gate_m: settings.gate_m,
            updates: assessment.updates,
            events: assessment.events.len(),
            events_left_out: assessment.events_left_out,
            values: values(&assessment.findings),
            findings: assessment.findings,
        },
    })
}

/// As a limit on the value; `None` without a threshold. What has no value is not met, like every limit.
fn check_of(finding: &Finding) -> Option<LimitCheck> {
    let threshold = finding.threshold;
    let is_lower = finding.comparison?.starts_with('>');
    let reason = match finding.value {
        None => Some(why_null(finding)),
        Some(_) if finding.each_target && finding.failed_target_count > 0 => {
            Some(match finding.failed_target_count {
                1 => "1 target fails by itself".to_owned(),
                failed => format!("{failed} targets fail by themselves"),
            })
        }
        Some(_) => None,
    };
    Some(LimitCheck {
        limit: Limit {
            quantity: format!("requirements.{}.{}", finding.sector_id, finding.requirement),
            at_most: threshold.filter(|_| !is_lower),
            at_least: threshold.filter(|_| is_lower),
            with: HeldAgainst::Value,
            cell: None,
        },
        met: finding.verdict == Some("pass"),
        value: finding.value,
        interval: finding.interval_95,
        margin: finding.margin,
        reason,
    })
}

fn write(assessment: &Assessment, truth: &TruthSet, tracks: &TrackSet) -> Artifact {
    let mut table = Table::new(false, &COLUMNS);
    for event in &assessment.events {
        let (finding, fault) = (&assessment.findings[event.finding], &event.fault);
        let target = fault.target.map(|index| &truth.targets()[index]);
        let track = fault.track.map(|index| &tracks.tracks[index as usize]);
        table.row(&[
            number(fault.time_s),
            target.map_or_else(String::new, |target| target.truth_id.clone()),
            track.map_or_else(String::new, |track| track.track_id.clone()),
            finding.sector_id.clone(),
            finding.requirement.clone(),
            fault.what.to_owned(),
            optional(fault.size.map(|(size, _)| size)),
            fault.size.map_or("", |(_, unit)| unit).to_owned(),
            optional(fault.place.map(|place| place.x)),
            optional(fault.place.map(|place| place.y)),
        ]);
    }
    table.artifact(FILE)
}
