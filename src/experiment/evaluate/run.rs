//! A job that judges tracks, step by step.

use super::EvaluateJob;
use super::automaton;
use super::compare::{Content, OF_BEARINGS, Subject};
use super::metrics::{Judgement, compute_metrics};
use super::profiles::accepts_bearings;
use super::requirements::{Held, HeldSubject, RequirementsSpec, hold};
use super::spec::Profile;
use super::within::Seen;
use crate::evaluation::metrics::BuildMetric;
use crate::evaluation::scope::LeftOut;
use crate::evaluation::{EvaluationInput, TfaSettings};
use crate::experiment::associate::track::{Tracked, track};
use crate::experiment::associate::{report, settle};
use crate::experiment::input::{JobData, missing};
use crate::experiment::job::{Artifact, Outcome, RunError, RunSettings, Work, to_value};
use crate::experiment::limits::LimitCheck;
use crate::experiment::observer::{Observer, Step, report_progress};
use crate::experiment::request::methods::Choice;
use crate::model::fault::Fault;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use serde_json::{Map, Value};
use std::borrow::Cow;

const WITHOUT_TRUTH: &str = "there is no truth with positions, so the automaton judged by the origins of the detections, and no metric \
                             (GOSPA, OSPA, SIAP, CLEAR, …) was computed; 'truth' gives it";

const OF_DIRECTIONS: &str = "the automaton does not read directions (bearing_deg) whose detections do not say which target they came from";

/// What a job says of its tracks.
struct AllJudged {
    parts: Map<String, Value>,
    files: Vec<Artifact>,
    checks: Vec<LimitCheck>,
}

type Metrics = [Choice<BuildMetric>];

/// What is judged, and by what.
type Judged<'d> = (Vec<Subject<'d>>, Cow<'d, Metrics>);

/// Loads, tracks if it must, and judges.
///
/// # Errors
/// [`RunError::Stopped`]; inputs that do not fit.
pub fn run(
    job: &EvaluateJob,
    work: Work,
    observer: &mut dyn Observer,
) -> Result<Outcome, RunError> {
    let (spec, settings) = (&job.spec, work.settings);
    let mut data = JobData::load(work.requests, work.inputs, &spec.sensors)?;
    let detector = spec.detector.as_ref();
    data.gather(
        &spec.input,
        detector,
        &spec.sensors,
        settings.seed,
        observer,
    )?;
    let mut result = Map::new();
    if let Some(detection) = &data.detection {
        result.insert("detection".to_owned(), to_value(detection)?);
    }
    let mut tracked = job.track(&mut data, settings, observer)?;
    if let Some(tracked) = &tracked {
        let association = report(tracked, data.recording()?, &data.sensors);
        result.insert("association".to_owned(), to_value(&association)?);
    }
    // Those who judge look at the recording's sensors, of which the job may know more; files have them as they came.
    let own = data.put_sensors(data.sensors.clone());
    let judged = job.judge(&mut data, tracked.as_ref(), settings, observer)?;
    data.put_sensors(own);
    result.extend(judged.parts);
    let association_time = tracked
        .as_ref()
        .and_then(|tracked| tracked.association_time);
    let mut artifacts = Vec::new();
    if settings.wants_files {
        let of_tracks = match &mut tracked {
            Some(tracked) => tracked.files(&mut data)?,
            None => Vec::new(),
        };
        let tracks = tracked.map(|tracked| tracked.tracks);
        artifacts = data.write(&spec.input, of_tracks, tracks, observer)?;
    }
    artifacts.extend(judged.files);
    Ok(Outcome {
        association_time,
        checks: judged.checks,
        ..data.into_outcome(Value::Object(result), artifacts)
    })
}

fn seen(data: &JobData) -> Option<Seen<'_>> {
    let recording = data.recording.as_ref();
    recording.map(|recording| (recording, &data.sensors[..]))
}

impl EvaluateJob {
    fn track(
        &self,
        data: &mut JobData,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<Option<Tracked>, RunError> {
        let Some(tracking) = &self.tracking else {
            return Ok(None);
        };
        let tracking = settle(tracking, data.recording()?);
        let (input, sensors) = (&self.spec.input, &self.spec.sensors);
        track(data, input, &tracking, sensors, settings, observer).map(Some)
    }

    /// What the automaton and the metrics say of the tracks, and of the smoothed ones; with the files of the former.
    fn judge(
        &self,
        data: &mut JobData,
        tracked: Option<&Tracked>,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<AllJudged, RunError> {
        let (mut result, mut files, mut checks) = (Map::new(), Vec::new(), Vec::new());
        let mut whole = None;
        if self.spec.comparison.within.is_some() {
            whole = data.truth.clone();
        }
        let made = tracked.map(|tracked| &tracked.tracks);
        let restricted = self.restrict(data, whole.as_ref(), made)?;
        let tracks = restricted.as_ref().map(|(tracks, _)| tracks).or(made);
        if self.wants_automaton(data)? {
            let judged = self.run_automaton(data, tracks, settings, observer)?;
            if let Some((report, of_automaton)) = judged {
                result.insert("tfa".to_owned(), report);
                files = of_automaton;
            }
        }
        let left_out = restricted.as_ref().map(|(_, left_out)| *left_out);
        let judgement = self.compute_metrics(data, tracks, left_out, settings, observer)?;
        if let Some(judgement) = judgement {
            result.extend(judgement.parts);
            files.extend(judgement.artifacts);
            data.warn(judgement.warnings);
        }
        if let Some(requirements) = &self.spec.requirements {
            let held = self.hold_requirements(requirements, data, tracks, settings, observer)?;
            result.insert("requirements".to_owned(), to_value(&held.report)?);
            files.extend(held.file);
            checks = held.checks;
        }
        if let Some(smoothed) = tracked.and_then(|tracked| tracked.smoothed.as_ref()) {
            let without_files = RunSettings {
                wants_files: false,
                ..settings
            };
            let restricted = self.restrict(data, whole.as_ref(), Some(smoothed))?;
            let tracks = restricted.as_ref().map_or(smoothed, |(tracks, _)| tracks);
            let left_out = restricted.as_ref().map(|(_, left_out)| *left_out);
            let judged =
                self.compute_metrics(data, Some(tracks), left_out, without_files, observer)?;
            // Its warnings are those of the tracks, which are alike in all but their places.
            let parts = judged.map(|judgement| Value::Object(judgement.parts));
            result.extend(parts.map(|parts| ("smoothed".to_owned(), parts)));
        }
        // The files have all of it.
        if whole.is_some() {
            data.truth = whole;
        }
        Ok(AllJudged {
            parts: result,
            files,
            checks,
        })
    }

    fn hold_requirements(
        &self,
        requirements: &RequirementsSpec,
        data: &JobData,
        tracked: Option<&TrackSet>,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<Held, RunError> {
        let comparison = &self.spec.comparison;
        let tracks = tracks_of(data, tracked)?;
        let truth = data.truth.as_ref();
        let truth = truth.ok_or_else(|| missing("/truth", "truth"))?;
        let gate_and_credit = (comparison.gate_m, comparison.credit());
        let subject = HeldSubject {
            truth,
            tracks,
            recording: seen(data),
        };
        let wants_files = settings.wants_files;
        hold(
            requirements,
            gate_and_credit,
            &subject,
            wants_files,
            observer,
        )
    }

    /// Puts what is due of the `whole` truth into the data; gives the tracks that are judged beside it. `None` where all is judged.
    fn restrict(
        &self,
        data: &mut JobData,
        whole: Option<&TruthSet>,
        tracked: Option<&TrackSet>,
    ) -> Result<Option<(TrackSet, LeftOut)>, RunError> {
        let comparison = &self.spec.comparison;
        let (Some(within), Some(whole)) = (&comparison.within, whole) else {
            return Ok(None);
        };
        let gate_and_paths = (comparison.gate_m, comparison.alignment.rule);
        let scope = within.scope(whole, seen(data))?;
        let (due, kept, left_out) =
            scope.restrict(whole, tracks_of(data, tracked)?, gate_and_paths);
        if due.targets().is_empty() {
            let detail = "no point of the truth lies within it, so nothing is due";
            return Err(Fault::new("/comparison/within", "empty", detail).into());
        }
        data.truth = Some(due);
        Ok(Some((kept, left_out)))
    }

    /// Whether there is a string to read: boxes have none.
    fn wants_automaton(&self, data: &JobData) -> Result<bool, RunError> {
        let spec = &self.spec;
        if !spec.sequences.is_empty() {
            return Ok(false);
        }
        if data.pairs.is_empty() {
            return Ok(spec.tfa.is_some() || spec.profile != Profile::Vision);
        }
        if spec.tfa.is_some() {
            let detail = "the automaton reads tracks in the plane, not boxes";
            let fault = Fault::new("/tfa", "unsupported", detail);
            return Err(fault.allowing("metrics hota, clear, identity").into());
        }
        if spec.profile == Profile::Tfa && spec.metrics.is_empty() {
            let detail =
                "the automaton reads tracks in the plane, not boxes, so nothing would be judged";
            let fault = Fault::new("/profile", "unsupported", detail);
            return Err(fault.allowing("vision").into());
        }
        Ok(false)
    }

    /// The part `tfa` of the report, and its files; `None` of directions that it cannot read, with a warning.
    fn run_automaton(
        &self,
        data: &mut JobData,
        tracked: Option<&TrackSet>,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<Option<(Value, Vec<Artifact>)>, RunError> {
        report_progress(observer, Step::Evaluate, 0, 1)?;
        let input = EvaluationInput {
            recording: data.recording.as_ref(),
            truth: data.truth.as_ref(),
            tracks: tracks_of(data, tracked)?,
        };
        let comparison = &self.spec.comparison;
        let tfa = self.spec.tfa;
        let Some(tfa) = tfa.or_else(|| automaton::default_settings(comparison, &input)) else {
            if self.spec.metrics.is_empty() {
                let fault = Fault::new(
                    "/profile",
                    "unsupported",
                    format!("{OF_DIRECTIONS}, so nothing would be judged"),
                );
                return Err(fault
                    .allowing("metrics of directions: clear, identity, hota")
                    .into());
            }
            data.warn(vec![OF_DIRECTIONS.to_owned()]);
            return Ok(None);
        };
        let tfa = TfaSettings {
            steps: comparison.steps(),
            credit: comparison.credit_of(tfa.symbols),
            ..tfa
        };
        let evaluation = automaton::evaluate(tfa, input, &data.sensors)?;
        let mut warnings = evaluation.strings.warnings.clone();
        let files = if settings.wants_files {
            automaton::artifacts(&evaluation, &mut warnings)?
        } else {
            Vec::new()
        };
        report_progress(observer, Step::Evaluate, 1, 1)?;
        let report = to_value(&evaluation.report())?;
        data.warn(warnings);
        Ok(Some((report, files)))
    }

    /// What the metrics say; `None` when there are none or no truth was found.
    fn compute_metrics(
        &self,
        data: &mut JobData,
        tracked: Option<&TrackSet>,
        left_out: Option<LeftOut>,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<Option<Judgement>, RunError> {
        let spec = &self.spec;
        if spec.metrics.is_empty() {
            let has_truth = data.truth.is_some() || !data.pairs.is_empty();
            if !has_truth && spec.profile != Profile::Tfa {
                data.warnings.push(WITHOUT_TRUTH.to_owned());
            }
            return Ok(None);
        }
        let mut warnings = Vec::new();
        let judged = if data.pairs.is_empty() {
            self.one_subject(data, tracked, &mut warnings)?
        } else {
            Some(self.subjects_of_pairs(data, &mut warnings)?)
        };
        let judgement = match judged {
            Some((subjects, metrics)) => Some(compute_metrics(
                &metrics,
                (&spec.comparison, left_out.unwrap_or_default()),
                &subjects,
                settings.wants_files,
                observer,
            )?),
            None => None,
        };
        data.warnings.extend(warnings);
        Ok(judgement)
    }

    /// The sequences, or the boxes of a job without sequences, with the metrics that they are judged by.
    fn subjects_of_pairs<'d>(
        &'d self,
        data: &'d JobData,
        warnings: &mut Vec<String>,
    ) -> Result<Judged<'d>, RunError> {
        let mut subjects = Vec::with_capacity(data.pairs.len());
        for (index, pair) in data.pairs.iter().enumerate() {
            let sequence = self.spec.sequences.get(index);
            let name = sequence.map(|sequence| sequence.name.as_str());
            subjects.push(Subject::new(name, index, pair)?);
        }
        let mut metrics = &self.spec.metrics;
        if let Some(of_boxes) = &self.metrics_of_boxes
            && subjects.iter().any(Subject::is_of_boxes)
        {
            warnings.push(
                "the data are boxes, so the metrics are those of the profile vision".to_owned(),
            );
            metrics = of_boxes;
        }
        Ok((subjects, Cow::Borrowed(metrics)))
    }

    /// The tracks of the job, with the metrics that they are judged by; `None` where nothing can be compared.
    fn one_subject<'d>(
        &'d self,
        data: &'d JobData,
        tracked: Option<&'d TrackSet>,
        warnings: &mut Vec<String>,
    ) -> Result<Option<Judged<'d>>, RunError> {
        let Some(truth) = &data.truth else {
            let warning = "no truth was found for this job, so no metric was computed";
            warnings.push(warning.to_owned());
            return Ok(None);
        };
        let tracks = tracks_of(data, tracked)?;
        let mut metrics = Cow::Borrowed(self.spec.metrics.as_slice());
        if !truth.space().has_places() || !tracks.space.has_places() {
            let are_alike = truth.space() == tracks.space;
            let Some(kept) = metrics_of_bearings(&metrics, are_alike, warnings) else {
                return Ok(None);
            };
            metrics = Cow::Owned(kept);
        }
        let input = EvaluationInput {
            recording: data.recording.as_ref(),
            truth: Some(truth),
            tracks,
        };
        let content = Content::Points { input, truth };
        Ok(Some((vec![Subject { name: "", content }], metrics)))
    }
}

/// The tracks that the job made, else those that it was given.
fn tracks_of<'d>(
    data: &'d JobData,
    tracked: Option<&'d TrackSet>,
) -> Result<&'d TrackSet, RunError> {
    tracked
        .or(data.tracks.as_ref())
        .ok_or_else(|| missing("/tracks", "tracks"))
}

/// Those of the metrics that directions can be judged by; `None` when there is none, or when only one side are directions.
fn metrics_of_bearings(
    metrics: &Metrics,
    are_alike: bool,
    warnings: &mut Vec<String>,
) -> Option<Vec<Choice<BuildMetric>>> {
    let (kept, others): (Vec<_>, Vec<_>) = metrics
        .iter()
        .partition(|metric| are_alike && accepts_bearings(metric));
    if kept.is_empty() {
        warnings.push(format!("{OF_BEARINGS}, so no metric was computed"));
        return None;
    }
    if !others.is_empty() {
        let names: Vec<&str> = others.iter().map(|metric| metric.name()).collect();
        warnings.push(format!(
            "{OF_BEARINGS}, so these metrics were not computed: {}",
            names.join(", ")
        ));
    }
    Some(kept.into_iter().cloned().collect())
}
