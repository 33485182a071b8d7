//! The report, in the names that users read. Absent values are null and no number is NaN.
//!
//! In records a symbol is shown by name, ε inside a string as "ε", and null is "outside the string".

use super::TfaSettings;
use super::model_check::{Broken, ViolationKind};
use super::output_tracks::{Classes, TrackClass};
use super::verdict::{Difference, TargetVerdict, Verdict};
use crate::evaluation::EvaluationInput;
use crate::evaluation::strings::normal_form::{StringSet, TrackString};
use crate::evaluation::strings::{Strings, SymbolRule};
use serde::Serialize;

/// How ε inside a string is written.
pub const EPSILON: &str = "ε";

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TfaReport {
    pub parameters: Parameters,
    pub counts: Counts,
    pub probability: Probabilities,
    pub ratios: Ratios,
    /// The truth strings are all among those that the automaton accepts.
    pub consistent: bool,
    /// Missed targets that a track is matched to: it began too late for the strict verdict.
    pub missed_with_matched_track: usize,
    pub targets: Vec<TargetReport>,
    pub output_tracks: Vec<OutputTrackReport>,
    pub violations: Vec<Violation>,
    pub unknown_detections: Vec<UnknownDetection>,
    pub warnings: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameters {
    /// `detection_id` or `nearest_truth`.
    pub symbols: &'static str,
    pub gate_m: Option<f64>,
    pub max_gap_s: Option<f64>,
    pub decision: &'static str,
    pub max_missed: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Counts {
    pub targets: usize,
    pub output_tracks: usize,
    pub correct: usize,
    pub missed: usize,
    #[serde(rename = "false")]
    pub wrong: usize,
    pub matched_tracks: usize,
    pub redundant_tracks: usize,
    pub false_tracks: usize,
}

/// Correct targets by output tracks; missed and false targets by targets.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Probabilities {
    pub correct: Option<f64>,
    pub missed: Option<f64>,
    #[serde(rename = "false")]
    pub wrong: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ratios {
    pub correct_per_target: Option<f64>,
    pub output_tracks_per_target: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetReport {
    pub truth_id: String,
    pub verdict: Verdict,
    /// Its strings lead from the start state to final states.
    pub reachable: bool,
    /// Number and time of the first scan at which truth and track differ; of false targets only.
    pub at_scan: Option<u32>,
    pub at_time_s: Option<f64>,
    /// What the truth string has at that scan; null after its end.
    pub expected: Option<String>,
    /// What the track has there; null after its end.
    pub took: Option<String>,
    pub took_kind: Option<TookKind>,
    pub took_truth_id: Option<String>,
    /// The track that speaks for the target; null when none began as its string does.
    pub track_id: Option<String>,
    pub errors: usize,
    /// Logarithm of the product of the weights along the paths of a correct target.
    pub log_probability: Option<f64>,
    /// How many scans the target has in its strings that are not ε, and how many strings.
    pub symbols: usize,
    pub strings: usize,
    pub start_scan: Option<u32>,
    pub end_scan: Option<u32>,
    pub matched_track_id: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TookKind {
    Clutter,
    Target,
    Epsilon,
    Ended,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputTrackReport {
    pub track_id: String,
    /// Which string of the track, from 1: a gap ends one output track and begins the next.
    pub part: u32,
    pub class: TrackClass,
    pub follows: Option<String>,
    pub start_scan: Option<u32>,
    pub end_scan: Option<u32>,
    /// Scans that are not ε.
    pub symbols: usize,
    /// Scans at which the track and the target it follows differ.
    pub errors: Option<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Violation {
    pub kind: ViolationKind,
    pub scan: u32,
    pub time_s: f64,
    pub detection_ids: Vec<String>,
    pub track_ids: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnknownDetection {
    pub track_id: String,
    pub scan: u32,
    pub time_s: f64,
    pub detection_id: String,
}

/// Everything found, by index; turned into names here.
pub struct Findings<'f, 'a> {
    pub input: &'f EvaluationInput<'a>,
    pub settings: &'f TfaSettings,
    pub strings: &'f Strings<'a>,
    pub verdicts: &'f [TargetVerdict],
    pub classes: &'f Classes,
    pub broken: &'f [Broken],
}

impl Findings<'_, '_> {
    pub fn report(&self) -> TfaReport {
        let output_tracks = self.output_tracks();
        let counts = self.counts(&output_tracks);
        let matched = self.verdicts.iter().zip(&self.classes.matched);
        TfaReport {
            parameters: parameters(self.settings),
            probability: Probabilities {
                correct: ratio(counts.correct, counts.output_tracks),
                missed: ratio(counts.missed, counts.targets),
                wrong: ratio(counts.wrong, counts.targets),
            },
            ratios: Ratios {
                correct_per_target: ratio(counts.correct, counts.targets),
                output_tracks_per_target: ratio(counts.output_tracks, counts.targets),
            },
            consistent: counts.correct == counts.targets,
            missed_with_matched_track: matched.filter(|(judged, track)| judged.verdict == Verdict::Missed && track.is_some()).count(),
            targets: (0..self.verdicts.len()).map(|target| self.target(target)).collect(),
            output_tracks,
            violations: self.broken.iter().map(|broken| self.violation(broken)).collect(),
            unknown_detections: self.unknown_detections(),
            warnings: self.strings.warnings.clone(),
            counts,
        }
    }

    fn counts(&self, output_tracks: &[OutputTrackReport]) -> Counts {
        let verdicts = |wanted| self.verdicts.iter().filter(|judged| judged.verdict == wanted).count();
        let classes = |wanted| output_tracks.iter().filter(|track| track.class == wanted).count();
        Counts {
            targets: self.verdicts.len(),
            output_tracks: output_tracks.len(),
            correct: verdicts(Verdict::Correct),
            missed: verdicts(Verdict::Missed),
            wrong: verdicts(Verdict::False),
            matched_tracks: classes(TrackClass::Matched),
            redundant_tracks: classes(TrackClass::Redundant),
            false_tracks: classes(TrackClass::False),
        }
    }

    fn target(&self, index: usize) -> TargetReport {
        let judged = &self.verdicts[index];
        let record = judged.first.as_ref().map(|first| self.record(first)).unwrap_or_default();
        let scan = judged.first.map(|first| self.strings.axis.at_position(first.position));
        let truth = &self.strings.truth;
        let own = &truth.strings()[truth.of_owner(index)];
        TargetReport {
            truth_id: self.strings.target_ids[index].to_owned(),
            verdict: judged.verdict,
            reachable: judged.verdict == Verdict::Correct,
            at_scan: scan.map(|scan| scan.number),
            at_time_s: scan.map(|scan| scan.time_s),
            expected: record.expected,
            took: record.took,
            took_kind: record.took_kind,
            took_truth_id: record.took_truth_id,
            track_id: judged.first.and_then(|first| first.speaker).map(|output| self.track_of(output)),
            errors: judged.errors,
            log_probability: judged.ln_weight.filter(|value| value.is_finite()),
            symbols: own.iter().map(|string| string.real).sum(),
            strings: own.len(),
            start_scan: own.first().map(|string| self.number_at(string.start)),
            end_scan: own.last().map(|string| self.number_at(string.end() - 1)),
            matched_track_id: self.classes.matched[index].map(|output| self.track_of(output)),
        }
    }

    fn record(&self, first: &Difference) -> Record {
        let inside = |set: &StringSet, string: &TrackString| {
            (first.position < string.end()).then(|| set.symbol_at(string, first.position))
        };
        let truth = &self.strings.truth;
        let expected = inside(truth, &truth.strings()[first.string]);
        let outputs = &self.strings.outputs.strings;
        // Where no track speaks nothing was taken: ε.
        let took = first.speaker.map_or(Some(None), |output| inside(outputs, &outputs.strings()[output]));
        let took_target = took.flatten().and_then(|symbol| self.strings.target_of(symbol));
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
            took_truth_id: took_target.map(|target| self.strings.target_ids[target as usize].to_owned()),
        }
    }

    /// The strings of each track in order, and the tracks that have none because they are ε throughout.
    fn output_tracks(&self) -> Vec<OutputTrackReport> {
        let outputs = &self.strings.outputs.strings;
        let mut empty = self.strings.outputs.empty_tracks.iter().peekable();
        let mut reports = Vec::with_capacity(outputs.strings().len());
        for track in 0..outputs.owners() {
            reports.extend(outputs.of_owner(track).map(|output| self.output_track(output)));
            if empty.next_if(|&&index| index as usize == track).is_some() {
                let track_id = self.input.tracks.tracks[track].track_id.clone();
                let (class, follows, start_scan, end_scan, errors) = (TrackClass::False, None, None, None, None);
                reports.push(OutputTrackReport { track_id, part: 1, class, follows, start_scan, end_scan, symbols: 0, errors });
            }
        }
        reports
    }

    fn output_track(&self, output: usize) -> OutputTrackReport {
        let string = &self.strings.outputs.strings.strings()[output];
        let following = self.classes.following[output];
        OutputTrackReport {
            track_id: self.track_of(output),
            part: string.part + 1,
            class: self.classes.class(output),
            follows: following.map(|following| self.strings.target_ids[following.target as usize].to_owned()),
            start_scan: Some(self.number_at(string.start)),
            end_scan: Some(self.number_at(string.end() - 1)),
            symbols: string.real,
            errors: following.map(|following| following.errors),
        }
    }

    fn violation(&self, broken: &Broken) -> Violation {
        let scan = &self.strings.axis.scans()[broken.scan];
        Violation {
            kind: broken.kind,
            scan: scan.number,
            time_s: scan.time_s,
            detection_ids: broken.detections.iter().map(|&detection| self.strings.identities.name(detection).to_owned()).collect(),
            track_ids: broken.tracks.iter().map(|&track| self.input.tracks.tracks[track as usize].track_id.clone()).collect(),
        }
    }

    fn unknown_detections(&self) -> Vec<UnknownDetection> {
        let named = self.strings.outputs.unknown.iter().map(|unknown| {
            let scan = &self.strings.axis.scans()[unknown.scan];
            UnknownDetection {
                track_id: self.input.tracks.tracks[unknown.track as usize].track_id.clone(),
                scan: scan.number,
                time_s: scan.time_s,
                detection_id: self.strings.identities.name(unknown.detection).to_owned(),
            }
        });
        named.collect()
    }

    fn track_of(&self, output: usize) -> String {
        let owner = self.strings.outputs.strings.strings()[output].owner;
        self.input.tracks.tracks[owner as usize].track_id.clone()
    }

    fn number_at(&self, position: usize) -> u32 {
        self.strings.axis.at_position(position).number
    }

    fn written(&self, symbol: Option<u32>) -> String {
        symbol.map_or(EPSILON, |symbol| self.strings.name_of(symbol)).to_owned()
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
        SymbolRule::NearestTruth { gate_m, max_gap_s } => ("nearest_truth", Some(gate_m), Some(max_gap_s)),
    };
    Parameters { symbols, gate_m, max_gap_s, decision: "most_probable", max_missed: settings.max_missed }
}

fn ratio(part: usize, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}
