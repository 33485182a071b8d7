//! Puts together the tracks of several sensors that are of one target, and fuses them.

mod align;
mod check;
mod decide;
mod nodes;
mod report;
mod run;
mod spec;

pub use report::CorrelateResult;
pub use spec::CORRELATE;

use crate::correlation::alignment::Node;
use crate::experiment::associate::check::{check_start, check_tracking};
use crate::experiment::associate::known::check_tracked_apart;
use crate::experiment::associate::settle;
use crate::experiment::associate::track::track;
use crate::experiment::input::known::check_inputs;
use crate::experiment::input::{JobData, missing};
use crate::experiment::job::{
    InputRequest, Job, Known, KnownInputs, Outcome, Planner, RunError, RunSettings, Work, to_value,
};
use crate::experiment::observer::Observer;
use crate::experiment::request::draft::{Draft, Planned};
use crate::experiment::request::methods::TrackingSpec;
use crate::model::fault::Fault;
use crate::model::space::Space;
use crate::model::track::TrackSet;
use nodes::Nodes;
use spec::Spec;

const IN_THE_PLANE: &str =
    "tracks of a volume (z_m) are put together in the plane, without heights";

#[derive(Clone)]
struct CorrelateJob {
    spec: Spec,
    tracking: Option<TrackingSpec>,
}

/// Plans a job that puts tracks together.
///
/// # Errors
/// All faults of the request.
pub fn plan(mut draft: Draft, _: Planner) -> Result<Planned, Vec<Fault>> {
    check::check_tracks(&mut draft);
    let of_scenario = check_tracking(&mut draft, false);
    let cost = check::check_drawn_tracks(&mut draft).unwrap_or(of_scenario);
    let inputs = draft.inputs();
    check_start(&mut draft, &inputs);
    draft.finish(inputs, cost, |spec: Spec| CorrelateJob {
        tracking: spec.tracking.whole(),
        spec,
    })
}

impl Job for CorrelateJob {
    fn check_known(&self, requests: &[InputRequest], known: &[Option<Known>]) -> KnownInputs {
        let Some(tracking) = &self.tracking else {
            return check_inputs(requests, known);
        };
        let found = check_tracked_apart(requests, known, tracking, &self.spec.sensors);
        found.into_known_inputs(tracking, |tracking| CorrelateJob {
            tracking: Some(tracking),
            ..self.clone()
        })
    }

    fn run(&self, work: Work, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
        let settings = work.settings;
        let Spec { input, sensors, .. } = &self.spec;
        let mut data = JobData::load(work.requests, work.inputs, sensors)?;
        data.gather(input, None, sensors, settings.seed, observer)?;
        let nodes = self.nodes(&mut data, settings, observer)?;
        let correlated = run::correlate(&self.spec, nodes, &mut data, settings, observer)?;
        let lines = report::tuple_lines(&correlated);
        let mut artifacts = Vec::new();
        if settings.wants_files {
            let files = report::artifacts(&correlated, &lines)?;
            artifacts = data.write(input, Vec::new(), None, observer)?;
            artifacts.extend(files);
        }
        let result = to_value(&report::report(&correlated, lines))?;
        Ok(Outcome {
            association_time: correlated.association_time,
            ..data.into_outcome(result, artifacts)
        })
    }
}

impl CorrelateJob {
    /// The tracks of each sensor: drawn, given, or made of its detections.
    fn nodes(
        &self,
        data: &mut JobData,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<Nodes, RunError> {
        if let Some(drawn) = &self.spec.input.tracks {
            let (nodes, truth) = nodes::draw_tracks(drawn, settings.seed)?;
            data.truth = Some(truth);
            return Ok(nodes);
        }
        match &self.tracking {
            Some(tracking) => self.track_by_sensor(tracking, data, settings, observer),
            None => {
                let sets = std::mem::take(&mut data.sets);
                if sets.iter().any(|set| set.space == Space::Volume) {
                    data.warn([IN_THE_PLANE.to_owned()]);
                }
                let sets = sets.into_iter().map(TrackSet::into_plane);
                Ok(nodes::name_sets(sets.collect()))
            }
        }
    }

    /// The tracks of each sensor by itself, all with one filter.
    fn track_by_sensor(
        &self,
        tracking: &TrackingSpec,
        data: &mut JobData,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<Nodes, RunError> {
        let all = data.recording.take();
        let all = all.ok_or_else(|| missing("/input", "detections"))?;
        let tracking = settle(tracking, &all);
        if tracking.chosen.is_some() {
            // The result has no part for how the tracks of each sensor were made.
            let name = tracking.filter.name;
            data.warnings
                .push(format!("the filter of the tracks is '{name}'"));
        }
        let mut sensors = data.sensors.clone();
        let mut nodes = Nodes {
            truth_ids: all.targets.clone(),
            ..Nodes::default()
        };
        let mut origins = Vec::new();
        for sensor in &mut sensors {
            let sensor_id = sensor.sensor_id.clone();
            let own = all.only_sensors(std::slice::from_ref(&sensor_id))?;
            data.recording = Some(own);
            data.sensors = vec![sensor.clone()];
            let (input, requested) = (&self.spec.input, &self.spec.sensors);
            let tracked = track(data, input, &tracking, requested, settings, observer)?;
            // With what was estimated.
            *sensor = data.sensors[0].clone();
            origins.extend(nodes::by_detections(&tracked.tracks, data.recording()?));
            if tracked.tracks.space == Space::Volume {
                data.warn([IN_THE_PLANE.to_owned()]);
            }
            let tracks = tracked.tracks.into_plane();
            nodes.nodes.push(Node { sensor_id, tracks });
        }
        nodes.origins = all.origins_known.then_some(origins);
        (data.recording, data.sensors) = (Some(all), sensors);
        Ok(nodes)
    }
}
