//! Strings: what a target or a track was, scan by scan, in one normal form.
//!
//! A string has one symbol a scan: a detection (or under `nearest_truth` a target), or ε for none. Normal form:
//! it starts and ends with a real symbol, inside there are fewer than `max_missed` ε in a row, and what follows a
//! longer gap is a new string. Outside its strings a target or track reads as ε.
//!
//! - *Truth strings*: the detections that came from the target; of several in one scan the one listed first counts.
//! - *Output strings*: the decision of the track at each scan, see [`outputs`]. Tentative scans belong to a track that
//!   was confirmed later where it is credited afterwards; a track that was never confirmed is no output.

mod choices;
pub mod difference;
pub mod normal_form;
pub mod outputs;
pub mod step;

use super::EvaluationInput;
use super::axis::Axis;
use super::credit::Credit;
use super::identities::Identities;
use super::nearest_detection::NearestDetection;
use super::nearest_truth::NearestTruth;
use super::paths::{Alignment, Paths};
use super::spaces;
use super::steps::{StepRule, StepSettings, Steps};
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;
use crate::model::truth::TruthSet;
use normal_form::StringSet;
use outputs::Outputs;
use serde::Deserialize;
use step::StringStep;

/// What the symbols of strings are.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SymbolRule {
    /// Detections, by identity: needs a recording that knows the origins of its detections.
    DetectionId,
    /// Detections: the nearest one of the same scan within `gate_m` of the track. Needs what `DetectionId` needs.
    NearestDetection { gate_m: f64 },
    /// Targets: the nearest one within `gate_m` of the track. Truth is interpolated over gaps of at most `max_gap_s`.
    NearestTruth {
        gate_m: f64,
        /// `None` is what the metrics bridge where nobody says it.
        max_gap_s: Option<f64>,
    },
}

/// How a track's weights become symbols.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "policy", rename_all = "snake_case")]
pub enum DecisionPolicy {
    /// The most probable candidate, ε included.
    MostProbable,
    /// Every candidate of at least this weight; ε too, or where nothing else is.
    AllGated { min_weight: f64 },
}

/// How strings are written.
#[derive(Debug, Clone, Copy)]
pub struct StringRules<'r> {
    pub symbols: SymbolRule,
    pub decision: DecisionPolicy,
    /// This many ε in a row end a string.
    pub max_missed: u32,
    /// What is known of the recording's sensors, in its order; `None` is what the recording itself says.
    pub sensors: Option<&'r [SensorSettings]>,
    /// Whose times count; symbols that are detections are always at the scans of the recording.
    pub steps: StepSettings,
    pub credit: Credit,
}

/// Where the symbols of tracks come from.
#[derive(Clone, Copy)]
pub enum Source<'s, 'a> {
    Candidates(DecisionPolicy),
    NearestDetection(&'s NearestDetection),
    NearestTruth(&'s NearestTruth<'a>),
}

/// Truth and tracks as strings on one axis.
pub struct Strings<'a> {
    pub axis: Axis,
    /// Names of the targets, in the order of `truth`'s owners.
    pub target_ids: Vec<&'a str>,
    pub truth: StringSet,
    pub outputs: Outputs,
    pub identities: Identities<'a>,
    pub warnings: Vec<String>,
    symbols_are_targets: bool,
}

impl Strings<'_> {
    pub fn name_of(&self, symbol: u32) -> &str {
        if self.symbols_are_targets {
            self.target_ids[symbol as usize]
        } else {
            self.identities.name(symbol)
        }
    }

    /// The target behind a symbol; `None` is clutter.
    pub fn target_of(&self, symbol: u32) -> Option<u32> {
        if self.symbols_are_targets {
            Some(symbol)
        } else {
            self.identities.origin(symbol)
        }
    }

    /// Index of the truth string that has a symbol at a place of the axis.
    pub fn truth_string_of(&self, symbol: u32, position: usize) -> Option<usize> {
        let own = self.truth.of_owner(self.target_of(symbol)? as usize);
        let passed =
            self.truth.strings()[own.clone()].partition_point(|string| string.end() <= position);
        let string = own.start + passed;
        (string < own.end
            && self
                .truth
                .symbol_at(&self.truth.strings()[string], position)
                == Some(symbol))
        .then_some(string)
    }
}

/// Writes truth and tracks as strings.
///
/// # Errors
/// The inputs that the rule of symbols needs and does not have.
pub fn write_strings<'a>(
    input: &EvaluationInput<'a>,
    rules: &StringRules,
) -> Result<Strings<'a>, Vec<Fault>> {
    check_places(input, rules.symbols)?;
    match rules.symbols {
        SymbolRule::NearestTruth { gate_m, max_gap_s } => {
            by_nearest_truth(input, gate_m, max_gap_s, rules)
        }
        SymbolRule::DetectionId => by_detection(input, None, rules),
        SymbolRule::NearestDetection { gate_m } => by_detection(input, Some(gate_m), rules),
    }
}

/// Only detection ids can be compared without a place: a direction is no number of metres away from anything.
fn check_places(input: &EvaluationInput, rule: SymbolRule) -> Result<(), Vec<Fault>> {
    let needs_truth = matches!(rule, SymbolRule::NearestTruth { .. });
    let truth = input.truth.filter(|_| needs_truth);
    let spaces = [
        ("tracks", Some(input.tracks.space)),
        ("truth", truth.map(TruthSet::space)),
    ];
    let fault = |name: &str| {
        let detail = format!(
            "the {name} are directions (bearing_deg): what is nearest to them in metres is not defined"
        );
        Fault::new("/tfa/symbols", "unsupported", detail).allowing("detection_id")
    };
    let faults: Vec<Fault> = spaces
        .iter()
        .filter(|(_, space)| space.is_some_and(|space| !space.has_places()))
        .map(|(name, _)| fault(name))
        .collect();
    if rule == SymbolRule::DetectionId || faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

/// Symbols are detections: those that tracks name, or the nearest within a gate.
fn by_detection<'a>(
    input: &EvaluationInput<'a>,
    gate_m: Option<f64>,
    rules: &StringRules,
) -> Result<Strings<'a>, Vec<Fault>> {
    let Some(recording) = input.recording else {
        return Err(vec![Fault::new(
            "/detections",
            "missing",
            "'detections' is required when symbols are detections",
        )]);
    };
    if !recording.origins_known {
        let detail = "the detections do not say which target they came from, so the tracks cannot be compared by detection";
        return Err(vec![
            Fault::new("/tfa/symbols", "unsupported", detail).allowing("nearest_truth"),
        ]);
    }
    let sensors = rules.sensors.unwrap_or(&recording.sensors);
    let nearest = gate_m
        .map(|gate_m| NearestDetection::new(recording, sensors, input.tracks.space, gate_m))
        .transpose()?;
    // Nearly all tracks are at the times of the scans exactly; then nobody has to go through their times beforehand.
    let exact = rules.steps.time_tolerance_s.is_none().then(|| {
        on_scans(
            input,
            recording,
            Steps::exactly(recording),
            nearest.as_ref(),
            rules,
        )
    });
    Ok(exact
        .filter(|strings| strings.outputs.lost == 0)
        .unwrap_or_else(|| {
            on_scans(
                input,
                recording,
                Steps::of_detections(recording, input.tracks, rules.steps.time_tolerance_s),
                nearest.as_ref(),
                rules,
            )
        }))
}

/// Strings on the scans of a recording; `steps` are their times.
fn on_scans<'a>(
    input: &EvaluationInput<'a>,
    recording: &'a Recording,
    mut steps: Steps,
    nearest: Option<&NearestDetection>,
    rules: &StringRules,
) -> Strings<'a> {
    let &StringRules {
        decision,
        max_missed,
        ..
    } = rules;
    let mut warnings = std::mem::take(&mut steps.warnings);
    let axis = Axis::of_recording(recording, input.tracks, steps, max_missed);
    let mut identities = Identities::new(Some(recording), &input.tracks.detection_ids);
    if let Some(alone) = nearest
        .map(|nearest| nearest.bearings_alone)
        .filter(|&alone| alone > 0)
    {
        warnings
            .push(format!("{alone} detection(s) are bearings alone, which are near to nothing, and were left out as symbols of tracks"));
    }
    if input.tracks.space == Space::Volume
        && nearest.is_some_and(|nearest| nearest.space == Space::Plane)
    {
        warnings.push("the tracks are of a volume, but not every detection has a z_m: the nearest detections are those in the plane".to_owned());
    }
    let target_ids = targets_of(recording, input.truth);
    let truth = truth_strings(
        recording,
        &axis,
        target_ids.len(),
        max_missed,
        &mut warnings,
    );
    let source = nearest.map_or(Source::Candidates(decision), Source::NearestDetection);
    let outputs = outputs::read(
        input.tracks,
        &axis,
        &mut identities,
        (source, rules.credit),
        max_missed,
        &mut warnings,
    );
    Strings {
        axis,
        target_ids,
        truth,
        outputs,
        identities,
        warnings,
        symbols_are_targets: false,
    }
}

fn by_nearest_truth<'a>(
    input: &EvaluationInput<'a>,
    gate_m: f64,
    max_gap_s: Option<f64>,
    rules: &StringRules,
) -> Result<Strings<'a>, Vec<Fault>> {
    let max_missed = rules.max_missed;
    let Some(truth) = input.truth else {
        return Err(vec![Fault::new(
            "/truth",
            "missing",
            "'truth' is required when symbols are the nearest targets",
        )]);
    };
    let paths = Paths::new(truth, Alignment::Interpolate { max_gap_s });
    let mut steps = Steps::new(input.recording, &paths, input.tracks, &rules.steps);
    let mut warnings = Vec::from_iter(spaces::warning(truth, input.tracks));
    warnings.append(&mut steps.warnings);
    let is_of_scans = matches!(rules.steps.rule, StepRule::Auto | StepRule::AsRecorded);
    let recording = input.recording.filter(|_| is_of_scans);
    let axis = match recording {
        Some(recording) => Axis::of_filled(recording, input.tracks, steps, max_missed),
        None => Axis::of_steps(steps),
    };
    let space = spaces::common(truth, input.tracks);
    let nearest = NearestTruth::new(paths, space, &axis, gate_m, recording.is_none())?;
    let mut strings = StringSet::new(max_missed);
    for (target, scans) in nearest.scans_of_target.iter().enumerate() {
        strings.push_owner(scans.iter().map(|&scan| {
            (
                axis.scans()[scan].position,
                StringStep::certain(target as u32),
            )
        }));
    }
    if nearest.never_watched > 0 {
        warnings.push(format!(
            "{} target(s) exist at no scan of the recording and were left out",
            nearest.never_watched
        ));
    }
    let mut identities = Identities::new(recording, &input.tracks.detection_ids);
    let outputs = outputs::read(
        input.tracks,
        &axis,
        &mut identities,
        (Source::NearestTruth(&nearest), rules.credit),
        max_missed,
        &mut warnings,
    );
    let target_ids = nearest
        .targets
        .iter()
        .map(|target| truth.targets()[*target].truth_id.as_str());
    Ok(Strings {
        target_ids: target_ids.collect(),
        axis,
        truth: strings,
        outputs,
        identities,
        warnings,
        symbols_are_targets: true,
    })
}

/// The targets that origins refer to, then those that only the truth names: they were never detected.
fn targets_of<'a>(recording: &'a Recording, truth: Option<&'a TruthSet>) -> Vec<&'a str> {
    let mut names: Vec<&str> = recording.targets.iter().map(String::as_str).collect();
    let detected: std::collections::HashSet<&str> = names.iter().copied().collect();
    let others = truth
        .map_or(&[][..], TruthSet::targets)
        .iter()
        .map(|target| target.truth_id.as_str());
    names.extend(others.filter(|name| !detected.contains(name)));
    names
}

fn truth_strings(
    recording: &Recording,
    axis: &Axis,
    targets: usize,
    max_missed: u32,
    warnings: &mut Vec<String>,
) -> StringSet {
    let DetectionsByTarget {
        ends,
        places,
        doubled,
    } = detections_by_target(recording, axis, targets);
    if doubled > 0 {
        warnings.push(format!("{doubled} detection(s) come from a target that already has one in the same scan; the first counts"));
    }
    let mut strings = StringSet::new(max_missed);
    strings.reserve(places.len(), targets);
    let mut first = 0;
    for (room, end) in ends {
        strings.push_owner(
            places[first..end]
                .iter()
                .map(|&(position, symbol)| (position as usize, StringStep::certain(symbol))),
        );
        first = room;
    }
    strings
}

struct DetectionsByTarget {
    /// For each target where the room for it ends in `places`, and where its entries end.
    ends: Vec<(usize, usize)>,
    /// Positions and detections, one target behind the other.
    places: Vec<(u32, u32)>,
    /// Detections left out because the target has one in the same scan.
    doubled: usize,
}

fn detections_by_target(recording: &Recording, axis: &Axis, targets: usize) -> DetectionsByTarget {
    let mut ends = vec![(0, 0); targets];
    for origin in recording
        .detections()
        .filter_map(|detection| detection.origin)
    {
        ends[origin as usize].0 += 1;
    }
    let mut total = 0;
    for (room, end) in &mut ends {
        *end = total;
        total += *room;
        *room = total;
    }
    let mut places = vec![(u32::MAX, 0); total];
    let mut doubled = 0;
    for ((first, scan), place) in recording.scans_with_firsts().zip(axis.scans()) {
        for (index, detection) in (first..).zip(&scan.detections) {
            let Some(origin) = detection.origin else {
                continue;
            };
            let first = origin
                .checked_sub(1)
                .map_or(0, |before| ends[before as usize].0);
            let end = &mut ends[origin as usize].1;
            if *end > first && places[*end - 1].0 == place.position as u32 {
                doubled += 1;
            } else {
                places[*end] = (place.position as u32, index as u32);
                *end += 1;
            }
        }
    }
    DetectionsByTarget {
        ends,
        places,
        doubled,
    }
}
