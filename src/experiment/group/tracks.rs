//! The tracks that predict reports.

use super::attributes::AttributeSet;
use super::instants::Instant;
use super::spec::{Loop, PredictionSpec, Start};
use crate::correlation::grouping::Place;
use crate::correlation::grouping::sequential_nearest_neighbour::SequentialNearestNeighbour;
use crate::experiment::job::refuse_any;
use crate::model::fault::Fault;
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::model::scan::{Detection, DetectionIndex, Recording};
use crate::model::sensor::Sensor;
use crate::model::state::{GaussianState, Position};
use crate::model::truth::TruthSet;
use crate::tracking::GroupTracks;

/// How tracks begin without truth: the sensors' reports in turn, within four σ.
const FIRST_GROUPS: SequentialNearestNeighbour = SequentialNearestNeighbour {
    gate_sigmas: 4.0,
    one_per_sensor: true,
};

/// What is grouped.
pub struct Scene<'a> {
    pub recording: &'a Recording,
    pub detections: DetectionIndex<'a>,
    pub sensors: &'a [Sensor],
    pub truth: Option<&'a TruthSet>,
    pub attributes: Option<AttributeSet>,
}

/// What needs the truth is refused where nobody knows it.
pub fn check_origins(settings: &PredictionSpec, recording: &Recording) -> Result<(), Vec<Fault>> {
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
    refuse_any(faults)
}

/// Tracks, and for each the target that its first reports came from.
pub struct Tracks {
    pub tracks: GroupTracks,
    targets: Vec<Option<u32>>,
}

/// The tracks of the first instant, each with all reports of its target or group.
pub fn begin(settings: &PredictionSpec, first: &Instant, scene: &Scene) -> Tracks {
    let motion = ConstantVelocity {
        spectral_density: settings.process_noise_m2ps3,
    };
    let mut begun = Tracks {
        tracks: GroupTracks::new(motion, first.time_s),
        targets: Vec::new(),
    };
    let groups = FIRST_GROUPS.groups(&first.reports);
    let mut keys: Vec<u64> = Vec::new();
    for ((&detection, report), group) in first.detections.iter().zip(&first.reports).zip(groups) {
        let Some(detection) = scene.detections.get(detection) else {
            continue;
        };
        let key = match (settings.start, detection.origin) {
            (Start::Truth, Some(origin)) => u64::from(origin),
            // Clutter begins no track at the truth.
            (Start::Truth, None) => continue,
            (Start::Groups, _) => group as u64,
        };
        let sensor = &scene.sensors[report.sensor as usize];
        if let Some(track) = keys.iter().position(|known| *known == key) {
            begun.update(track, sensor, detection);
            continue;
        }
        let origin = detection.origin.filter(|_| settings.start == Start::Truth);
        let velocity_mps = origin.and_then(|origin| scene.true_velocity_mps(origin, first.time_s));
        let (report, sigma_mps) = (&detection.measurement, settings.speed_sigma_mps);
        begun.tracks.begin(sensor, report, velocity_mps, sigma_mps);
        begun.targets.push(detection.origin);
        keys.push(key);
    }
    begun
}

impl Scene<'_> {
    fn true_velocity_mps(&self, origin: u32, time_s: f64) -> Option<Position> {
        let truth_id = &self.recording.targets[origin as usize];
        let truth = self.truth.filter(|truth| truth.space().has_places())?;
        let mut targets = truth.targets().iter();
        let target = targets.find(|target| target.truth_id == *truth_id)?;
        let velocity_mps = target.velocity_at(truth.space(), time_s, 0.0)?;
        Some(velocity_mps.xy())
    }
}

impl Tracks {
    pub fn update(&mut self, track: usize, sensor: &Sensor, detection: &Detection) {
        self.tracks.update(track, sensor, &detection.measurement);
    }

    fn places(&self) -> Vec<Place> {
        let place = |state: &GaussianState| Place {
            position_m: Position::new(state.mean[0], state.mean[1]),
            covariance: state.covariance.fixed_view::<2, 2>(0, 0).into_owned(),
        };
        self.tracks.states().iter().map(place).collect()
    }

    /// What the tracks expect of an instant at their time.
    pub fn expect(&self, instant: &mut Instant, attributes: Option<&AttributeSet>) {
        instant.predictions = self.places();
        if let (Some(described), Some(attributes)) = (&mut instant.described, attributes) {
            let states = self.tracks.states().iter();
            described.predictions = states.map(|state| attributes.of_state(state)).collect();
        }
    }

    /// The open loop.
    pub fn predict_all(&mut self, instants: &mut [Instant], scene: &Scene) {
        for instant in instants {
            self.tracks.predict(instant.time_s);
            self.expect(instant, scene.attributes.as_ref());
            for (&detection, report) in instant.detections.iter().zip(&instant.reports) {
                let Some(detection) = scene.detections.get(detection) else {
                    continue;
                };
                let track = detection.origin.and_then(|origin| {
                    self.targets
                        .iter()
                        .position(|target| *target == Some(origin))
                });
                if let Some(track) = track {
                    self.update(track, &scene.sensors[report.sensor as usize], detection);
                }
            }
        }
    }
}
