//! Why things happened, as the report and the file tell it.

use super::compare::Subject;
use super::spec::ComparisonSpec;
use crate::evaluation::causes::{self, Cause, Episode, Fate};
use crate::evaluation::events::EventKind;
use crate::evaluation::metrics::Sequence;
use crate::experiment::files::tables::{Table, number, optional};
use crate::experiment::job::Artifact;
use crate::model::watch::Watch;
use serde::Serialize;
use std::collections::BTreeMap;

/// Every episode, with why it is one.
pub const CAUSES: &str = "causes.csv";

/// Breaks that the report explains; all of them are in the file.
const MAX_BREAKS: usize = 1000;

const COLUMNS: [&str; 15] = [
    "event",
    "cause",
    "from_step",
    "to_step",
    "from_s",
    "to_s",
    "steps",
    "truth_id",
    "track_id",
    "other_truth_id",
    "other_track_id",
    "seen_scans",
    "scans",
    "last_detection_time_s",
    "sentence",
];

/// A target that was followed, and at this time is not.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = TrackBreak))]
pub struct Break {
    /// Where several sequences are judged: the one that it happened in.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sequence: Option<String>,
    pub time_s: f64,
    pub truth_id: String,
    pub track_id: String,
    /// What became of the track.
    pub cause: Fate,
    /// The target that the track followed from then on, or took detections of.
    pub other_truth_id: Option<String>,
    /// Scans up to this one, in a row, without a detection within the gate of the target; null without detections, and of directions.
    pub unseen_scans: Option<u32>,
    /// When the track was last given a detection; null where tracks do not say.
    pub last_detection_time_s: Option<f64>,
    /// Why, in words.
    #[cfg_attr(feature = "service", schema(required = false))]
    pub sentence: String,
}

/// How often events of one kind had one cause.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct CauseCount {
    /// As in `events.csv`: `miss`, `break`, `switch`, `false_alarm`, `redundant`, `divergence`.
    pub event: EventKind,
    pub cause: Cause,
    /// Stretches of such events in a row.
    pub episodes: u32,
    /// The events that they hold.
    pub events: u32,
}

/// The episodes of each sequence.
pub fn explain(sequences: &[Sequence], spec: &ComparisonSpec, watch: &Watch) -> Vec<Vec<Episode>> {
    let of_sequence = |sequence: &Sequence| {
        let input = sequence.input.as_ref();
        causes::explain(
            sequence.comparison,
            sequence.events,
            input,
            spec.credit(),
            watch,
        )
    };
    sequences.iter().map(of_sequence).collect()
}

/// By kind of event, then the most frequent first.
pub fn counts(episodes: &[Vec<Episode>]) -> Vec<CauseCount> {
    let mut found: BTreeMap<(EventKind, Cause), (u32, u32)> = BTreeMap::new();
    for episode in episodes.iter().flatten() {
        let (count, events) = found.entry((episode.event, episode.cause)).or_default();
        *count += 1;
        *events += episode.steps;
    }
    let count = |((event, cause), (episodes, events))| CauseCount {
        event,
        cause,
        episodes,
        events,
    };
    let mut counts: Vec<CauseCount> = found.into_iter().map(count).collect();
    counts.sort_by_key(|count| (count.event, std::cmp::Reverse(count.events)));
    counts
}

/// The first breaks of all sequences.
pub fn breaks(
    subjects: &[Subject],
    sequences: &[Sequence],
    episodes: &[Vec<Episode>],
) -> Vec<Break> {
    let are_several = subjects.len() > 1;
    let mut breaks = Vec::new();
    for ((subject, sequence), episodes) in subjects.iter().zip(sequences).zip(episodes) {
        for episode in episodes {
            let Some(fate) = episode.fate else {
                continue;
            };
            if breaks.len() == MAX_BREAKS {
                return breaks;
            }
            let name = are_several.then(|| subject.name.to_owned());
            breaks.push(tell_break(episode, fate, sequence, name));
        }
    }
    breaks
}

fn tell_break(episode: &Episode, cause: Fate, sequence: &Sequence, name: Option<String>) -> Break {
    let comparison = sequence.comparison;
    Break {
        sequence: name,
        time_s: comparison.steps[episode.from_step as usize].time_s,
        truth_id: id(&comparison.truth_ids, episode.truth).unwrap_or_default(),
        track_id: id(&comparison.track_ids, episode.track).unwrap_or_default(),
        cause,
        other_truth_id: id(&comparison.truth_ids, episode.other_truth),
        unseen_scans: episode.unseen_scans,
        last_detection_time_s: episode.last_detection_time_s,
        sentence: episode.sentence(comparison),
    }
}

fn id(ids: &[String], index: Option<u32>) -> Option<String> {
    ids.get(index? as usize).cloned()
}

/// The file of all episodes.
pub fn file(names: &[&str], sequences: &[Sequence], episodes: &[Vec<Episode>]) -> Artifact {
    let mut table = Table::new(names.len() > 1, &COLUMNS);
    for ((name, sequence), episodes) in names.iter().zip(sequences).zip(episodes) {
        table.begin(name);
        for episode in episodes {
            table.row(&row(episode, sequence));
        }
    }
    table.artifact(CAUSES)
}

fn row(episode: &Episode, sequence: &Sequence) -> [String; COLUMNS.len()] {
    let comparison = sequence.comparison;
    let time = |step: u32| number(comparison.steps[step as usize].time_s);
    let (truths, tracks) = (&comparison.truth_ids, &comparison.track_ids);
    [
        episode.event.name().to_owned(),
        episode.cause.name().to_owned(),
        (episode.from_step + 1).to_string(),
        (episode.to_step + 1).to_string(),
        time(episode.from_step),
        time(episode.to_step),
        episode.steps.to_string(),
        id(truths, episode.truth).unwrap_or_default(),
        id(tracks, episode.track).unwrap_or_default(),
        id(truths, episode.other_truth).unwrap_or_default(),
        id(tracks, episode.other_track).unwrap_or_default(),
        optional(episode.seen.map(|seen| f64::from(seen.seen))),
        optional(episode.seen.map(|seen| f64::from(seen.scans))),
        optional(episode.last_detection_time_s),
        episode.sentence(comparison),
    ]
}
