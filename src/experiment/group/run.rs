//! Groups the reports of several sensors, instant by instant, on tracks that predict them where the grouper wants some.
//!
//! Every track begins at the first instant, so that instant is not grouped where predictions are used. With an open loop the
//! tracks are updated with the reports that really are theirs: then the predictions, made before anything is grouped, are the
//! same for every grouper. With a closed loop they are updated with the groups that were found.

use super::attributes::{AttributeSet, DescribedInstant};
use super::instants::{Instant, instants_of};
use super::sensors::usable_sensors;
use super::spec::{Loop, Spec};
use super::tracks::{Scene, Tracks, begin, check_origins};
use crate::correlation::grouping::fuzzy_c_means::History;
use crate::correlation::grouping::{Grouper, Grouping, Snapshot};
use crate::evaluation::grouping::{GroupedReport, GroupingCounts};
use crate::experiment::input::JobData;
use crate::experiment::job::{AssociationTime, RunError};
use crate::experiment::observer::{Observer, Step, report_progress};
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::scan::{DetectionIndex, Recording};
use crate::model::sensor::Sensor;
use std::time::Duration;

/// The instants, each with its groups.
type Groupings = Vec<(Instant, Grouping)>;

/// The groups of all instants that were grouped.
pub struct Grouped {
    pub method: &'static str,
    pub instants: Groupings,
    /// Against the origins, where they are known.
    pub counts: Option<Vec<GroupingCounts>>,
    pub history: Option<History>,
    /// Names of what is compared.
    pub columns: Vec<&'static str>,
    /// How long the grouper took, where the observer has a clock.
    pub association_time: Option<AssociationTime>,
}

/// Groups the reports of every instant.
///
/// # Errors
/// [`RunError::Stopped`]; detections that cannot be grouped.
pub fn group(
    spec: &Spec,
    data: &JobData,
    seed: Seed,
    observer: &mut dyn Observer,
) -> Result<Grouped, RunError> {
    let mut grouper = spec.grouper.build(seed);
    let predictions = &spec.predictions;
    let recording = data.recording()?;
    let sensors = usable_sensors(recording, &data.sensors)?;
    let scene = Scene {
        recording,
        detections: recording.index_detections(),
        sensors: &sensors,
        truth: data.truth.as_ref(),
        attributes: attributes_of(spec, &*grouper, recording, &sensors)?,
    };
    let mut instants = instants_of(recording, &sensors)?;
    describe(&mut instants, &scene);
    let mut tracks = None;
    if grouper.uses_predictions() {
        check_origins(predictions, recording)?;
        let mut begun = begin(predictions, &instants.remove(0), &scene);
        match predictions.feedback {
            Loop::Open => begun.predict_all(&mut instants, &scene),
            Loop::Closed => tracks = Some(begun),
        }
    }
    let (grouped, spent) = group_all(&mut *grouper, instants, tracks, &scene, observer)?;
    let counts = recording.origins_known.then(|| {
        grouped
            .iter()
            .map(|pair| counts_of(&scene.detections, pair))
            .collect()
    });
    report_progress(observer, Step::Evaluate, 1, 1)?;
    let scans = grouped.len() as u64;
    Ok(Grouped {
        method: spec.grouper.name(),
        instants: grouped,
        counts,
        history: grouper.trace().cloned(),
        columns: scene
            .attributes
            .as_ref()
            .map_or_else(|| vec!["x_m", "y_m"], AttributeSet::columns),
        association_time: spent.map(|spent| AssociationTime { spent, scans }),
    })
}

/// What is compared instead of places; `None` where places are.
///
/// # Errors
/// A grouper or sensors that cannot.
pub fn attributes_of(
    spec: &Spec,
    grouper: &dyn Grouper,
    recording: &Recording,
    sensors: &[Sensor],
) -> Result<Option<AttributeSet>, Vec<Fault>> {
    if spec.attributes.is_empty() {
        return Ok(None);
    }
    if !grouper.takes_attributes() {
        let detail = format!("'{}' compares places", spec.grouper.name());
        return Err(vec![
            Fault::new("/attributes", "unsupported", detail)
                .allowing("nearest_neighbour or fuzzy_c_means"),
        ]);
    }
    AttributeSet::new(&spec.attributes, recording, sensors).map(Some)
}

fn describe(instants: &mut [Instant], scene: &Scene) {
    let Some(attributes) = &scene.attributes else {
        return;
    };
    for instant in instants {
        instant.described = Some(DescribedInstant {
            angles: attributes.angles(),
            reports: attributes.of_reports(instant, &scene.detections, scene.sensors),
            predictions: Vec::new(),
        });
    }
}

/// Every instant in turn, and how long the grouper took, where the observer has a clock. Tracks are those of a closed loop.
fn group_all(
    grouper: &mut dyn Grouper,
    instants: Vec<Instant>,
    mut tracks: Option<Tracks>,
    scene: &Scene,
    observer: &mut dyn Observer,
) -> Result<(Groupings, Option<Duration>), RunError> {
    let total = instants.len() as u64;
    report_progress(observer, Step::Associate, 0, total)?;
    let mut grouped = Vec::with_capacity(instants.len());
    let mut spent = Some(Duration::ZERO);
    for (number, mut instant) in (0..).zip(instants) {
        let begun = observer.now();
        let grouping = group_one(grouper, number, &mut instant, tracks.as_mut(), scene)
            .map_err(|faults| refuse(faults, instant.time_s))?;
        spent = spent
            .zip(begun)
            .zip(observer.now())
            .and_then(|((spent, begun), now)| Some(spent + now.checked_sub(begun)?));
        grouped.push((instant, grouping));
        report_progress(observer, Step::Associate, number + 1, total)?;
    }
    Ok((grouped, spent))
}

fn refuse(faults: Vec<Fault>, time_s: f64) -> RunError {
    let placed = |fault: Fault| Fault {
        pointer: format!("/grouper{}", fault.pointer),
        detail: format!("{} at {time_s} s", fault.detail),
        ..fault
    };
    RunError::Faults(faults.into_iter().map(placed).collect())
}

/// One instant; in a closed loop the tracks are predicted before it and updated after it.
fn group_one(
    grouper: &mut dyn Grouper,
    number: u64,
    instant: &mut Instant,
    mut closed: Option<&mut Tracks>,
    scene: &Scene,
) -> Result<Grouping, Vec<Fault>> {
    if let Some(tracks) = &mut closed {
        tracks.tracks.predict(instant.time_s);
        tracks.expect(instant, scene.attributes.as_ref());
    }
    let grouping = grouper.group(&Snapshot {
        number,
        reports: &instant.reports,
        predictions: &instant.predictions,
        described: instant.described.as_ref().map(DescribedInstant::view),
    })?;
    let Some(tracks) = closed else {
        return Ok(grouping);
    };
    let reports = instant.reports.iter().zip(&grouping.group_of);
    for (&detection, (report, &group)) in instant.detections.iter().zip(reports) {
        if group < instant.predictions.len()
            && let Some(detection) = scene.detections.get(detection)
        {
            let sensor = &scene.sensors[report.sensor as usize];
            tracks.update(group, sensor, detection);
        }
    }
    Ok(grouping)
}

fn counts_of(
    detections: &DetectionIndex,
    (instant, grouping): &(Instant, Grouping),
) -> GroupingCounts {
    let reports: Vec<GroupedReport> = instant
        .detections
        .iter()
        .zip(instant.reports.iter().zip(&grouping.group_of))
        .map(|(&detection, (report, &group))| GroupedReport {
            sensor: report.sensor,
            origin: detections.get(detection).and_then(|found| found.origin),
            group,
        })
        .collect();
    GroupingCounts::from_reports(&reports)
}
