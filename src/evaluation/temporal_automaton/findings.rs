//! From findings by index to the report by name.

use super::TfaSettings;
use super::model_check::Broken;
use super::output_tracks::{Classes, TrackClass};
use super::report::{
    Counts, EPSILON, OutputTrackReport, Parameters, Probabilities, Ratios, TargetReport, TfaReport, TookKind, UnknownDetection, Violation,
};
use super::verdict::{Difference, TargetVerdict, Verdict};
use crate::evaluation::EvaluationInput;
use crate::evaluation::strings::normal_form::{StringSet, TrackString};
use crate::evaluation::strings::{Strings, SymbolRule};

/// Everything found, by index.
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
        let inside = |set: &StringSet, string: &TrackString| (first.position < string.end()).then(|| set.symbol_at(string, first.position));
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
