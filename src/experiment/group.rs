//! Groups the reports of several sensors, instant by instant, on tracks that predict them where the grouper wants some.
//!
//! Every track begins at the first instant, so that instant is not grouped where predictions are used. With an open loop the
//! tracks are updated with the reports that really are theirs: then the predictions, made before anything is grouped, are the
//! same for every grouper. With a closed loop they are updated with the groups that were found.

use super::observer::{Observer, Step};
use super::run::{Decided, RunError};
use crate::correlation::grouping::sequential_nearest_neighbour::SequentialNearestNeighbour;
use crate::correlation::grouping::{GROUPERS, Grouper, Grouping, Place, SensorReport, Snapshot};
use crate::evaluation::grouping::{GroupedReport, GroupingCounts};
use crate::filtering::kalman::Kalman;
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, Scan};
use crate::model::sensor::{self, Sensor, SensorSettings};
use crate::model::state::{Position, PositionCovariance};
use crate::model::truth::TruthSet;
use crate::registry::{Bound, Kind, Object, default};
use crate::tracking::GroupTracks;
use serde::Deserialize;
use serde_json::Value;
use std::time::Duration;

/// How tracks begin without truth: the sensors' reports in turn, within four σ.
const FIRST_GROUPS: SequentialNearestNeighbour = SequentialNearestNeighbour {
    gate_sigmas: 4.0,
    one_per_sensor: true,
};

pub(super) static PREDICTIONS: Object = Object {
    name: "PredictionSettings",
    summary: "The constant-velocity Kalman tracks whose predictions a grouper may use. All begin at the first instant, which is then not grouped; none ends.",
    fields: &[
        default(
            "start",
            "truth: a track for each target, with its true reports, and its true velocity where truth is given; groups: one for each group of a sequential nearest neighbour within 4 σ.",
            Kind::Choice(&["truth", "groups"]),
            "\"truth\"",
        ),
        default(
            "loop",
            "open: tracks are updated with their true reports, so that every grouper meets the same predictions; closed: with the groups that were found.",
            Kind::Choice(&["open", "closed"]),
            "\"open\"",
        ),
        default(
            "process_noise_m2ps3",
            "Spectral density of the white-noise acceleration.",
            Kind::Number {
                min: Bound::Including(0.0),
                max: Bound::Including(1e9),
                unit: "m²/s³",
            },
            "100.0",
        ),
        default(
            "speed_sigma_mps",
            "Standard deviation of each component of a first velocity that is not known, around 0.",
            Kind::Number {
                min: Bound::Including(0.0),
                max: Bound::Including(1e5),
                unit: "m/s",
            },
            "300.0",
        ),
    ],
};

/// The parameters of `predictions`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
struct Settings {
    start: Start,
    #[serde(rename = "loop")]
    feedback: Loop,
    process_noise_m2ps3: f64,
    speed_sigma_mps: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Start {
    Truth,
    Groups,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Loop {
    Open,
    Closed,
}

/// The reports of one instant.
pub(super) struct Instant {
    pub time_s: f64,
    /// Their places in the recording, sensor by sensor.
    pub detections: Vec<usize>,
    pub reports: Vec<SensorReport>,
    /// Where the tracks were expected, when they were predicted beforehand.
    predictions: Vec<Place>,
}

/// The groups of all instants that were grouped.
pub(super) struct Grouped {
    pub method: &'static str,
    pub instants: Vec<(Instant, Grouping)>,
    /// Against the origins, where they are known.
    pub counts: Option<Vec<GroupingCounts>>,
    pub history: Option<crate::correlation::grouping::fuzzy_c_means::History>,
    /// How long the grouper took, where the observer has a clock.
    pub decided: Option<Decided>,
}

/// What a job of groups works on.
pub(super) struct Material<'a> {
    pub recording: &'a Recording,
    pub settings: &'a [SensorSettings],
    pub truth: Option<&'a TruthSet>,
}

pub(super) fn group(
    spec: &Value,
    seed: Seed,
    material: &Material,
    observer: &mut dyn Observer,
) -> Result<Grouped, RunError> {
    let unusable = |pointer: &str| {
        RunError::Faults(vec![Fault::new(
            pointer,
            "malformed",
            "the settings cannot be used",
        )])
    };
    let entry = GROUPERS
        .iter()
        .find(|entry| spec["grouper"]["method"] == entry.name)
        .ok_or_else(|| unusable("/grouper"))?;
    let mut grouper = (entry.build)(&spec["grouper"], seed).map_err(|_| unusable("/grouper"))?;
    let settings =
        Settings::deserialize(&spec["predictions"]).map_err(|_| unusable("/predictions"))?;
    let recording = material.recording;
    let sensors = usable_sensors(material)?;
    let mut instants = instants_of(recording, &sensors)?;
    let mut tracks = None;
    if grouper.uses_predictions() {
        check_origins(settings, recording)?;
        let mut begun = begin(settings, &instants.remove(0), material, &sensors);
        if settings.feedback == Loop::Open {
            begun.predict_all(&mut instants, recording, &sensors);
        }
        tracks = Some(begun);
    }
    let total = instants.len() as u64;
    told(observer, Step::Associate, 0, total)?;
    let mut grouped = Vec::with_capacity(instants.len());
    let mut spent = Some(Duration::ZERO);
    for (number, mut instant) in instants.into_iter().enumerate() {
        let closed = tracks
            .as_mut()
            .filter(|_| settings.feedback == Loop::Closed);
        let begun = observer.now();
        let grouping = group_one(
            &mut *grouper,
            number as u64,
            &mut instant,
            closed,
            (recording, &sensors),
        )?;
        spent = spent
            .zip(begun)
            .zip(observer.now())
            .and_then(|((spent, begun), now)| Some(spent + now.checked_sub(begun)?));
        grouped.push((instant, grouping));
        told(observer, Step::Associate, number as u64 + 1, total)?;
    }
    let counts = recording.origins_known.then(|| {
        grouped
            .iter()
            .map(|pair| counts_of(recording, pair))
            .collect()
    });
    told(observer, Step::Evaluate, 1, 1)?;
    let decided = spent.map(|spent| Decided {
        spent,
        scans: total,
    });
    Ok(Grouped {
        method: entry.name,
        instants: grouped,
        counts,
        history: grouper.trace().cloned(),
        decided,
    })
}

fn told(observer: &mut dyn Observer, step: Step, done: u64, total: u64) -> Result<(), RunError> {
    if observer.progress(step, done, total).is_break() {
        Err(RunError::Stopped)
    } else {
        Ok(())
    }
}

/// One instant; in a closed loop the tracks are predicted before it and updated after it.
fn group_one(
    grouper: &mut dyn Grouper,
    number: u64,
    instant: &mut Instant,
    closed: Option<&mut Tracks>,
    (recording, sensors): (&Recording, &[Sensor]),
) -> Result<Grouping, RunError> {
    let refused = |faults: Vec<Fault>, time_s: f64| {
        let placed = |fault: Fault| {
            let detail = format!("{} at {time_s} s", fault.detail);
            Fault {
                pointer: format!("/grouper{}", fault.pointer),
                detail,
                ..fault
            }
        };
        RunError::Faults(faults.into_iter().map(placed).collect())
    };
    let Some(tracks) = closed else {
        let snapshot = Snapshot {
            number,
            reports: &instant.reports,
            predictions: &instant.predictions,
        };
        return grouper
            .group(&snapshot)
            .map_err(|faults| refused(faults, instant.time_s));
    };
    tracks.tracks.predict(instant.time_s);
    instant.predictions = tracks.places();
    let snapshot = Snapshot {
        number,
        reports: &instant.reports,
        predictions: &instant.predictions,
    };
    let grouping = grouper
        .group(&snapshot)
        .map_err(|faults| refused(faults, instant.time_s))?;
    for (&detection, (report, &group)) in instant
        .detections
        .iter()
        .zip(instant.reports.iter().zip(&grouping.group_of))
    {
        if group < instant.predictions.len() {
            tracks.update(
                group,
                &sensors[report.sensor as usize],
                &recording.detections[detection],
            );
        }
    }
    Ok(grouping)
}

fn counts_of(recording: &Recording, (instant, grouping): &(Instant, Grouping)) -> GroupingCounts {
    let reports: Vec<GroupedReport> = instant
        .detections
        .iter()
        .zip(instant.reports.iter().zip(&grouping.group_of))
        .map(|(&detection, (report, &group))| GroupedReport {
            sensor: report.sensor,
            origin: recording.detections[detection].origin,
            group,
        })
        .collect();
    GroupingCounts::from_reports(&reports)
}

/// Sensors that report positions with known noise.
/// What of the input cannot be grouped.
pub(super) fn unusable(material: &Material) -> Vec<Fault> {
    match usable_sensors(material) {
        Err(RunError::Faults(faults)) => faults,
        _ => Vec::new(),
    }
}

fn usable_sensors(material: &Material) -> Result<Vec<Sensor>, RunError> {
    let mut faults = Vec::new();
    if material.settings.len() < 2 {
        let detail = format!(
            "the input has {} sensor, whose reports have nothing to be put together with",
            material.settings.len()
        );
        faults.push(Fault::new("/input", "unsupported", detail).allowing("two sensors or more"));
    }
    let mut sensors = Vec::with_capacity(material.settings.len());
    for (index, settings) in material.settings.iter().enumerate() {
        let scans = material
            .recording
            .scans
            .iter()
            .filter(|scan| scan.sensor == index);
        let mut detections = scans.flat_map(|scan| material.recording.detections_of(scan));
        if detections
            .any(|detection| !matches!(detection.measurement, Measurement::Position { .. }))
        {
            let detail = format!(
                "sensor '{}' reports directions, which are not put together",
                settings.sensor_id
            );
            faults
                .push(Fault::new("/input", "unsupported", detail).allowing("positions (x_m, y_m)"));
        }
        let (Some(sigma_x_m), Some(sigma_y_m)) = (settings.sigma_x_m, settings.sigma_y_m) else {
            let detail = format!(
                "the noise of sensor '{}' is not known: give 'sigma_x_m' and 'sigma_y_m' in 'sensors'",
                settings.sensor_id
            );
            faults.push(Fault::new("/sensors", "missing", detail).allowing("> 0 m"));
            continue;
        };
        let report = sensor::MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        };
        sensors.push(Sensor {
            sensor_id: settings.sensor_id.clone(),
            p_d: settings.p_d.unwrap_or(1.0),
            clutter_density: 0.0,
            report,
        });
    }
    if faults.is_empty() {
        Ok(sensors)
    } else {
        Err(RunError::Faults(faults))
    }
}

/// Scans of one time are one instant; one sensor alone makes none.
fn instants_of(recording: &Recording, sensors: &[Sensor]) -> Result<Vec<Instant>, RunError> {
    let together = recording
        .scans
        .chunk_by(|left, right| left.time_s == right.time_s)
        .filter(|scans| scans.len() > 1);
    let instants: Vec<Instant> = together
        .map(|scans| instant_of(recording, scans, sensors))
        .filter(|instant| !instant.reports.is_empty())
        .collect();
    if instants.len() > 1 {
        return Ok(instants);
    }
    let detail = format!(
        "the sensors have {} times in common at which anything was reported",
        instants.len()
    );
    Err(RunError::Faults(vec![
        Fault::new("/input", "disjoint", detail)
            .allowing("scans of two sensors or more at two times or more"),
    ]))
}

fn instant_of(recording: &Recording, scans: &[Scan], sensors: &[Sensor]) -> Instant {
    let mut instant = Instant {
        time_s: scans[0].time_s,
        detections: Vec::new(),
        reports: Vec::new(),
        predictions: Vec::new(),
    };
    for scan in scans {
        let sensor::MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        } = sensors[scan.sensor].report
        else {
            continue;
        };
        let covariance =
            PositionCovariance::new(sigma_x_m * sigma_x_m, 0.0, 0.0, sigma_y_m * sigma_y_m);
        for detection in scan.range() {
            if let Some(position_m) = recording.detections[detection].measurement.position() {
                instant.detections.push(detection);
                instant.reports.push(SensorReport {
                    place: Place {
                        position_m,
                        covariance,
                    },
                    sensor: scan.sensor as u32,
                });
            }
        }
    }
    instant
}

/// What needs the truth is refused where nobody knows it.
fn check_origins(settings: Settings, recording: &Recording) -> Result<(), RunError> {
    if recording.origins_known {
        return Ok(());
    }
    let mut faults = Vec::new();
    let mut refuse = |pointer: &str, what: &str, allowed: &str| {
        let detail = format!("{what}, but the detections do not say which target they came from");
        faults.push(
            Fault::new(pointer, "unsupported", detail)
                .allowing(format!("{allowed}, or detections with a 'truth_id' column")),
        );
    };
    if settings.start == Start::Truth {
        refuse("/predictions/start", "tracks begin at the truth", "groups");
    }
    if settings.feedback == Loop::Open {
        refuse(
            "/predictions/loop",
            "an open loop updates tracks with their true reports",
            "closed",
        );
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(RunError::Faults(faults))
    }
}

/// Tracks, and for each the target that its first reports came from.
struct Tracks {
    tracks: GroupTracks,
    targets: Vec<Option<u32>>,
}

/// The tracks of the first instant, each with all reports of its target or group.
fn begin(settings: Settings, first: &Instant, material: &Material, sensors: &[Sensor]) -> Tracks {
    let recording = material.recording;
    let filter = Kalman {
        process_noise_m2ps3: settings.process_noise_m2ps3,
    };
    let mut begun = Tracks {
        tracks: GroupTracks::new(filter, first.time_s),
        targets: Vec::new(),
    };
    let groups = FIRST_GROUPS.groups(&first.reports);
    let mut keys: Vec<u64> = Vec::new();
    for ((&detection, report), group) in first.detections.iter().zip(&first.reports).zip(groups) {
        let detection = &recording.detections[detection];
        let key = match (settings.start, detection.origin) {
            (Start::Truth, Some(origin)) => u64::from(origin),
            // Clutter begins no track at the truth.
            (Start::Truth, None) => continue,
            (Start::Groups, _) => group as u64,
        };
        let sensor = &sensors[report.sensor as usize];
        match keys.iter().position(|known| *known == key) {
            Some(track) => begun.update(track, sensor, detection),
            None => {
                let velocity_mps = detection
                    .origin
                    .filter(|_| settings.start == Start::Truth)
                    .and_then(|origin| {
                        let truth_id = &recording.targets[origin as usize];
                        let target = material
                            .truth?
                            .targets()
                            .iter()
                            .find(|target| target.truth_id == *truth_id)?;
                        target.velocity_at(first.time_s, 0.0)
                    });
                begun.tracks.begin(
                    sensor,
                    &report.place.position_m,
                    velocity_mps,
                    settings.speed_sigma_mps,
                );
                begun.targets.push(detection.origin);
                keys.push(key);
            }
        }
    }
    begun
}

impl Tracks {
    fn update(&mut self, track: usize, sensor: &Sensor, detection: &Detection) {
        if let Some(position_m) = detection.measurement.position() {
            self.tracks.update(track, sensor, &position_m);
        }
    }

    fn places(&self) -> Vec<Place> {
        let place = |state: &crate::model::state::GaussianState| Place {
            position_m: Position::new(state.mean[0], state.mean[1]),
            covariance: state.covariance.fixed_view::<2, 2>(0, 0).into_owned(),
        };
        self.tracks.states().iter().map(place).collect()
    }

    /// The open loop.
    fn predict_all(&mut self, instants: &mut [Instant], recording: &Recording, sensors: &[Sensor]) {
        for instant in instants {
            self.tracks.predict(instant.time_s);
            instant.predictions = self.places();
            for (&detection, report) in instant.detections.iter().zip(&instant.reports) {
                let detection = &recording.detections[detection];
                let track = detection.origin.and_then(|origin| {
                    self.targets
                        .iter()
                        .position(|target| *target == Some(origin))
                });
                if let Some(track) = track {
                    self.update(track, &sensors[report.sensor as usize], detection);
                }
            }
        }
    }
}
