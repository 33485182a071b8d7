//! From findings by index to the report by name.

use super::automaton::Automaton;
use super::evaluation::TfaEvaluation;
use super::model_check::Broken;
use super::output_tracks::TrackClass;
use super::report::{
    AutomatonSizes, Counts, EPSILON, OutputTrackReport, Parameters, Probabilities, Ratios, Size,
    TargetReport, TfaReport, Tolerance, TookKind, UnknownDetection, Violation,
};
use super::search::Order;
use super::shares;
use super::verdict::{Difference, Verdict};
use super::{TfaSettings, tolerant};
use crate::evaluation::strings::normal_form::{StringSet, TrackString};
use crate::evaluation::strings::{DecisionPolicy, SymbolRule};

/// At most so many violations, and so many unknown detections, are listed.
pub const MAX_LISTED: usize = 1000;

impl TfaEvaluation<'_> {
    pub fn report(&self) -> TfaReport {
        Findings(self).report()
    }
}

/// Everything found, by index.
struct Findings<'f, 'a>(&'f TfaEvaluation<'a>);

impl Findings<'_, '_> {
    fn report(&self) -> TfaReport {
        let found = self.0;
        let output_tracks = self.output_tracks();
        let counts = self.counts(&output_tracks);
        let tolerance = self.tolerance(counts.output_tracks);
        let matched = found.verdicts.iter().zip(&found.classes.matched);
        TfaReport {
            parameters: parameters(&found.settings),
            probability: Probabilities {
                correct: ratio(counts.correct, counts.output_tracks),
                missed: ratio(counts.missed, counts.targets),
                wrong: ratio(counts.wrong, counts.targets),
            },
            ratios: Ratios {
                correct_per_target: ratio(counts.correct, counts.targets),
                output_tracks_per_target: ratio(counts.output_tracks, counts.targets),
            },
            automaton: self.sizes(),
            shares: shares::shares(&counts, &tolerance),
            tolerance,
            consistent: counts.correct == counts.targets,
            missed_with_matched_track: matched
                .filter(|(judged, track)| judged.verdict == Verdict::Missed && track.is_some())
                .count(),
            targets: (0..found.verdicts.len())
                .map(|target| self.target(target))
                .collect(),
            output_tracks,
            violations: found
                .broken
                .iter()
                .take(MAX_LISTED)
                .map(|broken| self.violation(broken))
                .collect(),
            violations_left_out: counts.violations.saturating_sub(MAX_LISTED),
            unknown_detections: self.unknown_detections(),
            unknown_detections_left_out: counts.unknown_detections.saturating_sub(MAX_LISTED),
            warnings: found.strings.warnings.clone(),
            counts,
        }
    }

    fn sizes(&self) -> AutomatonSizes {
        let Size {
            states,
            transitions,
        } = self.0.size();
        let size = |automaton: &Automaton| Size {
            states: automaton.states(),
            transitions: automaton.transitions(),
        };
        AutomatonSizes {
            states,
            transitions,
            minimised: self.0.minimal.as_ref().map(size),
        }
    }

    fn tolerance(&self, output_tracks: usize) -> Vec<Tolerance> {
        let correct =
            tolerant::correct_by_budget(&self.0.least_errors, self.0.settings.tolerance as usize);
        let line = |(k, correct)| Tolerance {
            k,
            correct,
            probability: ratio(correct, output_tracks),
        };
        correct.into_iter().enumerate().map(line).collect()
    }

    fn counts(&self, output_tracks: &[OutputTrackReport]) -> Counts {
        let mut of_verdict = [0; 3];
        for judged in &self.0.verdicts {
            of_verdict[judged.verdict as usize] += 1;
        }
        let mut of_class = [0; 3];
        for track in output_tracks {
            of_class[track.class as usize] += 1;
        }
        Counts {
            targets: self.0.verdicts.len(),
            output_tracks: output_tracks.len(),
            correct: of_verdict[Verdict::Correct as usize],
            missed: of_verdict[Verdict::Missed as usize],
            late: (0..self.0.verdicts.len())
                .filter(|target| self.is_late(*target))
                .count(),
            wrong: of_verdict[Verdict::False as usize],
            matched_tracks: of_class[TrackClass::Matched as usize],
            redundant_tracks: of_class[TrackClass::Redundant as usize],
            false_tracks: of_class[TrackClass::False as usize],
            violations: self.0.broken.len(),
            unknown_detections: self.0.strings.outputs.unknown.len(),
        }
    }

    /// Missed, for no track began as the target does, but followed all the same.
    fn is_late(&self, target: usize) -> bool {
        let truth = &self.0.strings.truth;
        let strings = &truth.strings()[truth.of_owner(target)];
        let symbols: usize = strings.iter().map(|string| string.real).sum();
        self.0.verdicts[target].verdict == Verdict::Missed
            && self.0.least_errors[target].is_some_and(|errors| errors < symbols)
    }

    fn target(&self, index: usize) -> TargetReport {
        let judged = &self.0.verdicts[index];
        let record = judged
            .first
            .as_ref()
            .map(|first| self.record(first))
            .unwrap_or_default();
        let scan = judged
            .first
            .map(|first| self.0.strings.axis.at_position(first.position));
        let truth = &self.0.strings.truth;
        let own = &truth.strings()[truth.of_owner(index)];
        TargetReport {
            truth_id: self.0.strings.target_ids[index].to_owned(),
            verdict: judged.verdict,
            reachable: judged.verdict == Verdict::Correct,
            at_scan: scan.map(|scan| scan.number),
            at_time_s: scan.map(|scan| scan.time_s),
            expected: record.expected,
            took: record.took,
            took_kind: record.took_kind,
            took_truth_id: record.took_truth_id,
            track_id: judged
                .first
                .and_then(|first| first.speaker)
                .map(|output| self.track_of(output)),
            errors: judged.errors,
            least_errors: self.0.least_errors[index],
            log_probability: judged.ln_weight.filter(|value| value.is_finite()),
            symbols: own.iter().map(|string| string.real).sum(),
            strings: own.len(),
            start_scan: own.first().map(|string| self.number_at(string.start)),
            end_scan: own.last().map(|string| self.number_at(string.end() - 1)),
            matched_track_id: self.0.classes.matched[index].map(|output| self.track_of(output)),
        }
    }

    fn record(&self, first: &Difference) -> Record {
        let inside = |set: &StringSet, string: &TrackString| {
            (first.position < string.end()).then(|| set.symbol_at(string, first.position))
        };
        let truth = &self.0.strings.truth;
        let expected = inside(truth, &truth.strings()[first.string]);
        let outputs = &self.0.strings.outputs.strings;
        // Where no track speaks nothing was taken: ε.
        let took = first.speaker.map_or(Some(None), |output| {
            inside(outputs, &outputs.strings()[output])
        });
        let took_target = took
            .flatten()
            .and_then(|symbol| self.0.strings.target_of(symbol));
        let took_kind = match took {
            None => TookKind::Ended,
            Some(None) => TookKind::Epsilon,
            Some(Some(_)) if took_target.is_some() => TookKind::Target,
            Some(Some(_)) => TookKind::Clutter,
        };
        Record {
            expected: expected.map(|symbol| self.written(symbol)),
            took: took.map(|symbol| self.written(symbol)),
            took_kind: Some(took_kind),
            took_truth_id: took_target
                .map(|target| self.0.strings.target_ids[target as usize].to_owned()),
        }
    }

    /// The strings of each track in order, and the tracks that have none because they are ε throughout.
    fn output_tracks(&self) -> Vec<OutputTrackReport> {
        let outputs = &self.0.strings.outputs.strings;
        let mut empty = self.0.strings.outputs.empty_tracks.iter().peekable();
        let mut reports = Vec::with_capacity(outputs.strings().len());
        for track in 0..outputs.owners() {
            reports.extend(
                outputs
                    .of_owner(track)
                    .map(|output| self.output_track(output)),
            );
            if empty.next_if(|&&index| index as usize == track).is_some() {
                let track_id = self.0.input.tracks.tracks[track].track_id.clone();
                let (class, follows, start_scan, end_scan, errors) =
                    (TrackClass::False, None, None, None, None);
                reports.push(OutputTrackReport {
                    track_id,
                    part: 1,
                    class,
                    follows,
                    start_scan,
                    end_scan,
                    symbols: 0,
                    errors,
                });
            }
        }
        reports
    }

    fn output_track(&self, output: usize) -> OutputTrackReport {
        let string = &self.0.strings.outputs.strings.strings()[output];
        let following = self.0.classes.following[output];
        OutputTrackReport {
            track_id: self.track_of(output),
            part: string.part + 1,
            class: self.0.classes.class(output),
            follows: following
                .map(|following| self.0.strings.target_ids[following.target as usize].to_owned()),
            start_scan: Some(self.number_at(string.start)),
            end_scan: Some(self.number_at(string.end() - 1)),
            symbols: string.real,
            errors: following.map(|following| following.errors),
        }
    }

    fn violation(&self, broken: &Broken) -> Violation {
        let scan = &self.0.strings.axis.scans()[broken.scan as usize];
        Violation {
            kind: broken.kind,
            scan: scan.number,
            time_s: scan.time_s,
            detection_ids: broken
                .detections
                .iter()
                .map(|&detection| self.0.strings.identities.name(detection).to_owned())
                .collect(),
            track_ids: broken
                .tracks
                .iter()
                .map(|&track| self.0.input.tracks.tracks[track as usize].track_id.clone())
                .collect(),
        }
    }

    fn unknown_detections(&self) -> Vec<UnknownDetection> {
        let named = self
            .0
            .strings
            .outputs
            .unknown
            .iter()
            .take(MAX_LISTED)
            .map(|unknown| {
                let scan = &self.0.strings.axis.scans()[unknown.scan as usize];
                UnknownDetection {
                    track_id: self.0.input.tracks.tracks[unknown.track as usize]
                        .track_id
                        .clone(),
                    scan: scan.number,
                    time_s: scan.time_s,
                    detection_id: self.0.strings.identities.name(unknown.detection).to_owned(),
                }
            });
        named.collect()
    }

    fn track_of(&self, output: usize) -> String {
        let owner = self.0.strings.outputs.strings.strings()[output].owner;
        self.0.input.tracks.tracks[owner as usize].track_id.clone()
    }

    fn number_at(&self, position: usize) -> u32 {
        self.0.strings.axis.at_position(position).number
    }

    fn written(&self, symbol: Option<u32>) -> String {
        symbol
            .map_or(EPSILON, |symbol| self.0.strings.name_of(symbol))
            .to_owned()
    }
}

#[derive(Default)]
struct Record {
    expected: Option<String>,
    took: Option<String>,
    took_kind: Option<TookKind>,
    took_truth_id: Option<String>,
}

fn parameters(settings: &TfaSettings) -> Parameters {
    let (symbols, gate_m, max_gap_s) = match settings.symbols {
        SymbolRule::DetectionId => ("detection_id", None, None),
        SymbolRule::NearestDetection { gate_m } => ("nearest_detection", Some(gate_m), None),
        SymbolRule::NearestTruth { gate_m, max_gap_s } => {
            ("nearest_truth", Some(gate_m), max_gap_s)
        }
    };
    let (decision, min_weight) = match settings.decision {
        DecisionPolicy::MostProbable => ("most_probable", None),
        DecisionPolicy::AllGated { min_weight } => ("all_gated", Some(min_weight)),
    };
    let search = match settings.search {
        Order::BreadthFirst => "breadth_first",
        Order::DepthFirst => "depth_first",
    };
    let &TfaSettings {
        max_missed,
        tolerance,
        ..
    } = settings;
    Parameters {
        symbols,
        gate_m,
        max_gap_s,
        decision,
        min_weight,
        max_missed,
        tolerance,
        search,
    }
}

fn ratio(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}
