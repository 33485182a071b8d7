//! One evaluation: everything found, kept for the report and for the files beside it.

use super::TfaSettings;
use super::automaton::Automaton;
use super::births::Births;
use super::determinise::{determinise, minimise};
use super::export::AutomatonFile;
use super::model_check::{self, Broken};
use super::output_tracks::{self, Classes};
use super::paths::Paths;
use super::report::Size;
use super::search::RunSearch;
use super::tolerant::{self, Bridge};
use super::verdict::{self, Sides, TargetVerdict};
use super::weighted::{self, ScanProbability};
use crate::evaluation::strings::{self, StringRules, Strings};
use crate::evaluation::{EvaluationInput, id_order};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;

/// An automaton with more states than this is not minimised.
pub const MAX_MINIMISED_STATES: usize = 1_000_000;

pub struct TfaEvaluation<'a> {
    pub(super) input: EvaluationInput<'a>,
    pub(super) settings: TfaSettings,
    pub strings: Strings<'a>,
    track_ranks: Vec<u32>,
    births: Births,
    /// The table, where the strings alone are not the automaton.
    table: Option<Automaton>,
    pub(super) minimal: Option<Automaton>,
    pub(super) verdicts: Vec<TargetVerdict>,
    pub(super) classes: Classes,
    pub(super) broken: Vec<Broken>,
    pub(super) least_errors: Vec<Option<usize>>,
}

impl<'a> TfaEvaluation<'a> {
    /// `sensors` are what is known of the recording's sensors, in its order, when that is more than the recording says.
    ///
    /// # Errors
    /// Settings that make no sense; what is missing or unfit in the inputs for the chosen symbols.
    pub fn new(
        input: EvaluationInput<'a>,
        sensors: Option<&[SensorSettings]>,
        settings: TfaSettings,
    ) -> Result<Self, Vec<Fault>> {
        settings.check()?;
        let TfaSettings {
            symbols,
            decision,
            max_missed,
            steps,
            credit,
            ..
        } = settings;
        let strings = strings::write_strings(
            &input,
            &StringRules {
                symbols,
                decision,
                max_missed,
                sensors,
                steps,
                credit,
            },
        )?;
        Ok(Self::of_strings(input, settings, strings))
    }

    /// What follows when the strings are written.
    pub fn of_strings(
        input: EvaluationInput<'a>,
        settings: TfaSettings,
        mut strings: Strings<'a>,
    ) -> Self {
        let target_ranks = id_order::ranks(strings.target_ids.iter().copied());
        let track_ranks = id_order::ranks(
            input
                .tracks
                .tracks
                .iter()
                .map(|track| track.track_id.as_str()),
        );
        let outputs = &strings.outputs.strings;
        let births = Births::new(outputs);
        let sides = Sides {
            truth: &strings.truth,
            outputs,
            births: &births,
            track_ranks: &track_ranks,
        };
        let mut search = RunSearch::new(settings.search);
        let table = outputs
            .has_choices()
            .then(|| Automaton::of_strings(outputs, &births));
        let verdicts = match &table {
            Some(table) => verdict::judge(sides, table, &mut search),
            None => verdict::judge(
                sides,
                &Paths {
                    outputs,
                    births: &births,
                },
                &mut search,
            ),
        };
        let classes = output_tracks::classify(&strings, &target_ranks, &track_ranks);
        let broken = model_check::check(&strings.outputs);
        let (least_errors, bridges) = tolerant::least_errors(&strings, &verdicts);
        let bridged = bridge_gaps(&strings, input, &bridges);
        strings.warnings.extend(bridged);
        let minimal = settings
            .minimise
            .then(|| minimal(outputs, &births, &mut strings.warnings))
            .flatten();
        TfaEvaluation {
            input,
            settings,
            strings,
            track_ranks,
            births,
            table,
            minimal,
            verdicts,
            classes,
            broken,
            least_errors,
        }
    }

    /// The sizes of the automaton as built.
    pub fn size(&self) -> Size {
        if let Some(table) = &self.table {
            return Size {
                states: table.states(),
                transitions: table.transitions(),
            };
        }
        let symbols: usize = self
            .strings
            .outputs
            .strings
            .strings()
            .iter()
            .map(|string| string.steps().len())
            .sum();
        Size {
            states: 1 + symbols,
            transitions: symbols,
        }
    }

    /// The automaton as a file: the minimal one if it was asked for. `None` when it has more than `max_transitions`.
    pub fn automaton_file(&self, max_transitions: usize) -> Option<AutomatonFile> {
        if let Some(minimal) = &self.minimal {
            return (minimal.transitions() <= max_transitions)
                .then(|| AutomatonFile::new(minimal, true, &self.strings));
        }
        (self.size().transitions <= max_transitions).then(|| {
            let outputs = &self.strings.outputs.strings;
            let automaton = Automaton::of_strings(outputs, &self.births);
            AutomatonFile::new(&automaton, false, &self.strings)
        })
    }

    /// How probable each truth string is, scan by scan. `None` when the truth strings have more than `max_scans` in all.
    pub fn scan_probabilities(&self, max_scans: usize) -> Option<Vec<ScanProbability>> {
        let truth = &self.strings.truth;
        let scans: usize = truth
            .strings()
            .iter()
            .map(|string| string.steps().len())
            .sum();
        let outputs = &self.strings.outputs.strings;
        let sides = Sides {
            truth,
            outputs,
            births: &self.births,
            track_ranks: &self.track_ranks,
        };
        (scans <= max_scans).then(|| weighted::scan_probabilities(&self.strings, sides))
    }

    /// The name of a track, by its index.
    pub fn track_id(&self, track: u32) -> &'a str {
        &self.input.tracks.tracks[track as usize].track_id
    }
}

/// A warning where one track goes on across gaps that end strings of its target.
fn bridge_gaps(strings: &Strings, input: EvaluationInput, bridges: &[Bridge]) -> Option<String> {
    let first = bridges.first()?;
    let (target, track) = (
        strings.target_ids[first.target as usize],
        &input.tracks.tracks[first.track as usize].track_id,
    );
    Some(format!(
        "{} track(s) go on across a gap of {} scans or more that ends a string of their target, first track '{track}' of target '{target}': \
         least_errors give each string a track of its own, so that what follows the gap counts as missing there unless another track took it \
         up; the errors of the output track count the scans that differ alone",
        bridges.len(),
        strings.truth.max_missed()
    ))
}

fn minimal(
    outputs: &strings::normal_form::StringSet,
    births: &Births,
    warnings: &mut Vec<String>,
) -> Option<Automaton> {
    let deterministic = determinise(
        &Automaton::of_strings(outputs, births),
        MAX_MINIMISED_STATES,
    );
    if deterministic.is_none() {
        warnings.push(format!(
            "the automaton was not minimised: it would take more than {MAX_MINIMISED_STATES} states"
        ));
    }
    deterministic.map(|deterministic| minimise(&deterministic))
}
