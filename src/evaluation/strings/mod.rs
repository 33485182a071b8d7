//! Strings: what a target or a track was, scan by scan, in one normal form.
//!
//! A string has one symbol a scan: a detection (or under `nearest_truth` a target), or ε for none. Normal form:
//! it starts and ends with a real symbol, inside there are fewer than `max_missed` ε in a row, and what follows a
//! longer gap is a new string. Outside its strings a target or track reads as ε.
//!
//! - *Truth strings*: the detections that came from the target; of several in one scan the one listed first counts.
//! - *Output strings*: the decision of the track at each scan, see [`outputs`]. Tentative scans belong to a track that
//!   was confirmed later; a track that was never confirmed is no output.

pub mod normal_form;
pub mod outputs;

use super::EvaluationInput;
use super::axis::Axis;
use super::identities::Identities;
use super::nearest_truth::NearestTruth;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::truth::TruthSet;
use normal_form::{Step, StringSet};
use outputs::Outputs;

/// What the symbols of strings are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SymbolRule {
    /// Detections, by identity: needs a recording that knows the origins of its detections.
    DetectionId,
    /// Targets: the nearest one within `gate_m` of the track. Truth is interpolated over gaps of at most `max_gap_s`.
    NearestTruth { gate_m: f64, max_gap_s: f64 },
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
        if self.symbols_are_targets { self.target_ids[symbol as usize] } else { self.identities.name(symbol) }
    }

    /// The target behind a symbol; `None` is clutter.
    pub fn target_of(&self, symbol: u32) -> Option<u32> {
        if self.symbols_are_targets { Some(symbol) } else { self.identities.origin(symbol) }
    }
}

/// Writes truth and tracks as strings.
///
/// # Errors
/// The inputs that the rule of symbols needs and does not have.
pub fn write_strings<'a>(input: &EvaluationInput<'a>, rule: SymbolRule, max_missed: u32) -> Result<Strings<'a>, Vec<Fault>> {
    check_places(input, rule)?;
    match rule {
        SymbolRule::DetectionId => by_detection(input, max_missed),
        SymbolRule::NearestTruth { gate_m, max_gap_s } => by_nearest_truth(input, gate_m, max_gap_s, max_missed),
    }
}

/// Only detection ids can be compared without a place: a direction is no number of metres away from anything.
fn check_places(input: &EvaluationInput, rule: SymbolRule) -> Result<(), Vec<Fault>> {
    let of_bearings = [("tracks", input.tracks.is_of_bearings()), ("truth", input.truth.is_some_and(TruthSet::is_of_bearings))];
    let fault = |(name, _): &(&str, bool)| {
        let detail = format!("the {name} are directions (bearing_deg): what is nearest to them in metres is not defined");
        Fault::new("/tfa/symbols", "unsupported", detail).allowing("detection_id")
    };
    let faults: Vec<Fault> = of_bearings.iter().filter(|(_, is_of_bearings)| *is_of_bearings).map(fault).collect();
    if rule == SymbolRule::DetectionId || faults.is_empty() { Ok(()) } else { Err(faults) }
}

fn by_detection<'a>(input: &EvaluationInput<'a>, max_missed: u32) -> Result<Strings<'a>, Vec<Fault>> {
    let Some(recording) = input.recording else {
        return Err(vec![Fault::new("/detections", "missing", "'detections' is required when symbols are detection ids")]);
    };
    if !recording.origins_known {
        let detail = "the detections do not say which target they came from, so they cannot be compared by detection id";
        return Err(vec![Fault::new("/tfa/symbols", "unsupported", detail).allowing("nearest_truth")]);
    }
    let axis = Axis::of_recording(recording, input.tracks, max_missed);
    let mut identities = Identities::new(Some(recording), &input.tracks.detection_ids);
    let mut warnings = Vec::new();
    let target_ids = targets_of(recording, input.truth);
    let truth = truth_strings(recording, &axis, target_ids.len(), max_missed, &mut warnings);
    let outputs = outputs::read(input.tracks, &axis, &mut identities, None, max_missed, &mut warnings);
    Ok(Strings { axis, target_ids, truth, outputs, identities, warnings, symbols_are_targets: false })
}

fn by_nearest_truth<'a>(input: &EvaluationInput<'a>, gate_m: f64, max_gap_s: f64, max_missed: u32) -> Result<Strings<'a>, Vec<Fault>> {
    let Some(truth) = input.truth else {
        return Err(vec![Fault::new("/truth", "missing", "'truth' is required when symbols are the nearest targets")]);
    };
    let axis = match input.recording {
        Some(recording) => Axis::of_recording(recording, input.tracks, max_missed),
        None => Axis::of_tracks(input.tracks),
    };
    let nearest = NearestTruth::new(truth, &axis, gate_m, max_gap_s, input.recording.is_none());
    let mut strings = StringSet::new(max_missed);
    for (target, scans) in nearest.scans_of_target.iter().enumerate() {
        strings.push_owner(scans.iter().map(|&scan| (axis.scans()[scan].position, Step::certain(target as u32))));
    }
    let mut warnings = Vec::new();
    if nearest.never_watched > 0 {
        warnings.push(format!("{} target(s) exist at no scan of the recording and were left out", nearest.never_watched));
    }
    let mut identities = Identities::new(input.recording, &input.tracks.detection_ids);
    let outputs = outputs::read(input.tracks, &axis, &mut identities, Some(&nearest), max_missed, &mut warnings);
    Ok(Strings { axis, target_ids: nearest.target_ids, truth: strings, outputs, identities, warnings, symbols_are_targets: true })
}

/// The targets that origins refer to, then those that only the truth names: they were never detected.
fn targets_of<'a>(recording: &'a Recording, truth: Option<&'a TruthSet>) -> Vec<&'a str> {
    let mut names: Vec<&str> = recording.targets.iter().map(String::as_str).collect();
    let detected: std::collections::HashSet<&str> = names.iter().copied().collect();
    let others = truth.map_or(&[][..], TruthSet::targets).iter().map(|target| target.truth_id.as_str());
    names.extend(others.filter(|name| !detected.contains(name)));
    names
}

fn truth_strings(recording: &Recording, axis: &Axis, targets: usize, max_missed: u32, warnings: &mut Vec<String>) -> StringSet {
    let mut steps: Vec<Vec<(usize, Step)>> = vec![Vec::new(); targets];
    let mut doubled = 0_usize;
    for (scan, place) in recording.scans.iter().zip(axis.scans()) {
        for index in scan.range() {
            let Some(origin) = recording.detections[index].origin else { continue };
            let of_target = &mut steps[origin as usize];
            match of_target.last() {
                Some(&(position, _)) if position == place.position => doubled += 1,
                _ => of_target.push((place.position, Step::certain(index as u32))),
            }
        }
    }
    if doubled > 0 {
        warnings.push(format!("{doubled} detection(s) come from a target that already has one in the same scan; the first counts"));
    }
    let mut strings = StringSet::new(max_missed);
    steps.into_iter().for_each(|of_target| strings.push_owner(of_target));
    strings
}
