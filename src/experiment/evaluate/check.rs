//! What of a request that judges tracks no table can see.

use super::requirements::RequirementsSpec;
use super::within::WithinSpec;
use crate::experiment::associate::check::fill_tracking_defaults;
use crate::experiment::job::InputRequest;
use crate::experiment::request::draft::Draft;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;

const SUBJECTS: [&str; 3] = ["input", "tracks", "sequences"];

/// A request tracks `input` first, or takes `tracks` or `sequences`: exactly one of them, with the settings that go with it.
pub fn check_subject(draft: &mut Draft) {
    let given: Vec<&str> = SUBJECTS
        .into_iter()
        .filter(|name| draft.has(name))
        .collect();
    match given.as_slice() {
        ["input"] => fill_tracking_defaults(draft),
        ["tracks"] => {
            let why = "needs 'input'; 'tracks' are judged as they are";
            draft.refuse(&["associator", "filter", "tracker"], why);
            if !draft.has("detections") {
                draft.refuse(&["sensors"], why);
            }
        }
        [_] => {
            let why = "does not go with 'sequences': each has its own truth and tracks, for metrics alone";
            let names = [
                "associator",
                "filter",
                "tracker",
                "sensors",
                "truth",
                "detections",
                "tfa",
            ];
            draft.refuse(&names, why);
            check_sequences(draft);
        }
        [] => {
            let detail = "give 'input' to track first, or 'tracks' or 'sequences' to judge";
            draft.add([Fault::new("", "missing", detail).allowing(SUBJECTS.join(", "))]);
        }
        [first, second, ..] => {
            let detail = format!("give either '{first}' or '{second}', not both");
            draft.add([Fault::new(format!("/{second}"), "conflict", detail)]);
        }
    }
}

/// Sequences are told apart by name, and only metrics judge them.
fn check_sequences(draft: &mut Draft) {
    let count = draft.length_of("sequences").unwrap_or(0);
    let names: Vec<Option<String>> = (0..count)
        .map(|index| {
            draft
                .text_at(&format!("/sequences/{index}/name"))
                .map(str::to_owned)
        })
        .collect();
    for (index, name) in names.iter().enumerate() {
        if let Some(told) = name
            && names[..index].contains(name)
        {
            let detail = format!("two sequences are called '{told}'");
            draft.add([
                Fault::new(format!("/sequences/{index}/name"), "duplicate", detail)
                    .allowing("each name once"),
            ]);
        }
    }
    if draft.text_at("/profile") == Some("tfa") && draft.length_of("metrics").unwrap_or(0) == 0 {
        let detail = "the automaton does not judge sequences, so nothing would be judged";
        draft.add([Fault::new("/profile", "unsupported", detail)
            .allowing("tracking, vision, or metrics of your own")]);
    }
}

/// The automaton cannot read symbols that no input gives.
pub fn check_symbols(draft: &mut Draft, inputs: &[InputRequest]) {
    let mut known: Vec<DatasetKind> = inputs
        .iter()
        .filter(|input| input.sequence.is_none())
        .map(|input| input.role)
        .collect();
    if known.contains(&DatasetKind::BearingTime) {
        // They are found in the record.
        known.push(DatasetKind::Detections);
    }
    let symbols = draft.text_at("/tfa/symbols/kind").map(str::to_owned);
    let (wanted, name) = match symbols.as_deref() {
        Some("detection_id" | "nearest_detection") => (DatasetKind::Detections, "detections"),
        Some("nearest_truth") => (DatasetKind::Truth, "truth"),
        None if draft.has("tracks") && known == [DatasetKind::Tracks] => {
            let detail = "'truth' is required to judge tracks, or 'detections' that know which target they came from";
            return draft.add([Fault::new("/truth", "missing", detail)]);
        }
        _ => return,
    };
    let is_simulated = draft.at("/input/scenario").is_some() || draft.at("/input/preset").is_some();
    let is_given = draft.has(name) || draft.has("sequences");
    if !is_simulated && !is_given && !known.is_empty() && !known.contains(&wanted) {
        let symbols = symbols.unwrap_or_default();
        let detail = format!("'{name}' is required when the symbols are {symbols}");
        draft.add([Fault::new(format!("/{name}"), "missing", detail)]);
    }
}

/// A grid needs its spacing, and nothing else does.
pub fn check_steps(draft: &mut Draft) {
    let is_grid = draft.text_at("/comparison/steps") == Some("every_s");
    let has_spacing = draft.at("/comparison/every_s").is_some();
    let pointer = "/comparison/every_s";
    if is_grid && !has_spacing {
        let detail = "'every_s' is required when the steps are every_s";
        draft.add([Fault::new(pointer, "missing", detail)
            .allowing("the time between two steps, above 0 s")]);
    }
    if has_spacing && !is_grid {
        let detail = "'every_s' goes with steps every_s alone";
        draft.add([
            Fault::new(pointer, "conflict", detail).allowing("steps every_s, or no every_s")
        ]);
    }
}

/// What is judged of one recording; a whole one where symbols are detections.
pub fn check_within(draft: &mut Draft) {
    let Some(within) = draft.read::<WithinSpec>("/comparison/within") else {
        return;
    };
    draft.add(within.faults());
    let pointer = "/comparison/within";
    if draft.has("sequences") {
        let detail = "sequences are judged whole";
        draft.add([Fault::new(pointer, "unsupported", detail).allowing("a job for each sequence")]);
    }
    if matches!(
        draft.text_at("/tfa/symbols/kind"),
        Some("detection_id" | "nearest_detection")
    ) {
        let detail = "an automaton on detections reads whole recordings";
        let fault = Fault::new("/tfa/symbols/kind", "conflict", detail);
        draft.add([fault.allowing("nearest_truth, or no 'within'")]);
    }
}

/// Requirements are held against the truth of one recording.
pub fn check_requirements(draft: &mut Draft, inputs: &[InputRequest]) {
    let Some(requirements) = draft.read::<RequirementsSpec>("/requirements") else {
        return;
    };
    draft.add(requirements.faults());
    let pointer = "/requirements";
    if draft.has("sequences") {
        let detail = "requirements are of one recording";
        draft.add([Fault::new(pointer, "unsupported", detail).allowing("a job for each sequence")]);
    } else if !inputs.is_empty() && !draft.knows_truth(inputs) {
        let detail = "'truth' is required when requirements are asked for";
        draft.add([Fault::new("/truth", "missing", detail)]);
    }
}
