//! Truth and tracks put side by side for the metrics, and what makes them impossible to compare.

use super::metrics::NamedMetric;
use super::spec::{ComparisonSpec, METRICS_OF_BEARINGS};
use crate::evaluation::EvaluationInput;
use crate::evaluation::comparison::{ComparedStep, Comparison, PointSettings};
use crate::evaluation::extent::Extent;
use crate::evaluation::nearness;
use crate::evaluation::spaces;
use crate::experiment::input::TruthAndTracks;
use crate::experiment::job::{RunError, refuse_any};
use crate::model::boxes::BoxSet;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::space::Space;
use crate::model::truth::TruthSet;
use crate::model::watch::Watch;

pub const OF_BEARINGS: &str = "directions (bearing_deg) are not compared in metres";

const FARTHEST_DEG: f64 = 179.999;

/// Truth and tracks of one recording or run.
pub struct Subject<'a> {
    /// As the request calls it; empty where there is only one.
    pub name: &'a str,
    pub content: Content<'a>,
}

pub enum Content<'a> {
    /// `truth` is the truth of `input`.
    Points {
        input: EvaluationInput<'a>,
        truth: &'a TruthSet,
    },
    Boxes {
        truth: &'a BoxSet,
        tracks: &'a BoxSet,
    },
}

impl<'a> Content<'a> {
    pub fn input(&self) -> Option<EvaluationInput<'a>> {
        match *self {
            Content::Points { input, .. } => Some(input),
            Content::Boxes { .. } => None,
        }
    }
}

impl<'a> Subject<'a> {
    /// Truth and tracks of one sequence, or of a job that compares boxes.
    ///
    /// # Errors
    /// They are not of one kind.
    pub fn new(
        name: Option<&'a str>,
        index: usize,
        pair: &'a TruthAndTracks,
    ) -> Result<Self, RunError> {
        let content = match (&pair.truth, &pair.tracks) {
            (Some(Dataset::Truth(truth)), Some(Dataset::Tracks(tracks))) => {
                if truth.space().has_places() != tracks.space.has_places() {
                    let allowed = "truth and tracks of one kind";
                    return Err(unlike(name, index, OF_BEARINGS, allowed).into());
                }
                let input = EvaluationInput {
                    recording: None,
                    truth: Some(truth),
                    tracks,
                };
                Content::Points { input, truth }
            }
            (Some(Dataset::TruthBoxes(truth)), Some(Dataset::TrackBoxes(tracks))) => {
                Content::Boxes { truth, tracks }
            }
            _ => {
                let detail = "truth and tracks are not of one kind";
                let allowed = "both in the plane, or both boxes";
                return Err(unlike(name, index, detail, allowed).into());
            }
        };
        let name = name.unwrap_or_default();
        Ok(Subject { name, content })
    }

    pub fn is_of_boxes(&self) -> bool {
        matches!(self.content, Content::Boxes { .. })
    }

    /// The name before a warning, where there are several.
    pub fn prefix(&self) -> String {
        if self.name.is_empty() {
            String::new()
        } else {
            format!("{}: ", self.name)
        }
    }
}

fn unlike(name: Option<&str>, index: usize, detail: &str, allowed: &str) -> Fault {
    let place = name.map_or_else(String::new, |_| format!("/sequences/{index}"));
    Fault::new(format!("{place}/truth"), "unsupported", detail).allowing(allowed)
}

/// Compares every subject with its truth, as far as the metrics look.
///
/// # Errors
/// A stop, tables that grow too large, and what cannot be compared or judged by these metrics.
pub fn compare(
    spec: &ComparisonSpec,
    subjects: &[Subject],
    metrics: &[NamedMetric],
    watch: &Watch,
) -> Result<Vec<Comparison>, RunError> {
    let reach_m = metrics
        .iter()
        .map(|named| named.metric.reach_m(spec.gate_m))
        .fold(spec.gate_m, f64::max);
    let places = PointSettings {
        alignment: spec.alignment.rule,
        gate_m: spec.gate_m,
        reach_m,
        steps: spec.steps(),
        credit: spec.credit(),
    };
    let of_directions = metrics
        .iter()
        .filter(|named| named.metric.accepts(Some(Space::Bearing)))
        .map(|named| named.metric.reach_deg(spec.gate_deg));
    let directions = PointSettings {
        gate_m: spec.gate_deg,
        // Farther apart than half a turn is nobody.
        reach_m: of_directions
            .fold(spec.gate_deg, f64::max)
            .min(FARTHEST_DEG),
        ..places
    };
    let mut extent = Extent::new(watch);
    let mut comparisons = Vec::with_capacity(subjects.len());
    for subject in subjects {
        comparisons.push(match &subject.content {
            Content::Points { input, truth } if !truth.space().has_places() => {
                Comparison::of_points_within(input, truth, &directions, &mut extent)
            }
            Content::Points { input, truth } => {
                Comparison::of_points_within(input, truth, &places, &mut extent)
            }
            Content::Boxes { truth, tracks } => {
                Comparison::of_boxes_within(truth, tracks, spec.min_iou, &mut extent)
            }
        });
    }
    extent.finish()?;
    refuse_shapes(metrics, &comparisons)?;
    let pairs = subjects.iter().zip(&comparisons).enumerate();
    let faults = pairs
        .filter_map(|(index, (subject, comparison))| disjoint_times(index, subject, comparison))
        .collect();
    refuse_any(faults)?;
    Ok(comparisons)
}

/// A warning where no track ever comes within the gate of a target: what is far apart is rather of two units or clocks than missed.
pub fn never_near(subject: &Subject, comparison: &Comparison) -> Option<String> {
    let Content::Points { input, truth } = &subject.content else {
        return None;
    };
    if !comparison.is_in_metres()
        || comparison
            .pairs
            .iter()
            .any(|pair| pair.distance <= comparison.gate)
    {
        return None;
    }
    let least_m = nearness::least_distance(comparison);
    let space = comparison.space.unwrap_or_default();
    let shift_s = nearness::clock_shift_s(truth, input.tracks, space, comparison.gate);
    let shifted = shift_s.map(|shift_s| {
        let (size_s, direction) = (shift_s.abs(), if shift_s < 0.0 { "earlier" } else { "later" });
        format!("; with the times of the tracks {size_s:.3} s {direction} they would meet: do both have one clock?")
    });
    let question = "; are both in one unit and in the same coordinates?".to_owned();
    least_m.is_finite().then(|| {
        format!(
            "{}no track ever comes within the gate of a target: the least distance is {least_m:.1} m, the gate {} m{}",
            subject.prefix(),
            comparison.gate,
            shifted.unwrap_or(question)
        )
    })
}

/// Truth and tracks whose times do not meet: any number made of them would mislead.
fn disjoint_times(index: usize, subject: &Subject, comparison: &Comparison) -> Option<Fault> {
    let (tracks_span, truth_span) = spans_of(subject)?;
    if times_meet(subject, comparison) {
        return None;
    }
    let pointer = if subject.name.is_empty() {
        "/truth".to_owned()
    } else {
        format!("/sequences/{index}/truth")
    };
    let (what, unit, allowed) = match subject.content {
        Content::Points { .. } => (
            "times",
            " s",
            "truth at the times of the tracks, on the same clock",
        ),
        Content::Boxes { .. } => (
            "frames",
            "",
            "truth in the frames of the tracks, counted alike",
        ),
    };
    let spans = format!(
        "({} to {}{unit}) and of tracks ({} to {}{unit})",
        truth_span.0, truth_span.1, tracks_span.0, tracks_span.1
    );
    Some(
        Fault::new(
            pointer,
            "disjoint",
            format!("the {what} of truth {spans} do not meet"),
        )
        .allowing(allowed),
    )
}

/// The first and the last time (or frame) of the tracks and of the truth.
fn spans_of(subject: &Subject) -> Option<((f64, f64), (f64, f64))> {
    match &subject.content {
        Content::Points { input, truth } => {
            let tracks = input.tracks.tracks.iter();
            let tracks_s = tracks
                .flat_map(|track| &track.points)
                .map(|point| point.time_s);
            let targets = truth.targets().iter();
            let truth_s = targets
                .flat_map(|target| &target.points)
                .map(|point| point.time_s);
            Some((span(tracks_s)?, span(truth_s)?))
        }
        Content::Boxes { truth, tracks } => {
            let frames = |set: &BoxSet| span(set.boxes().iter().map(|one| f64::from(one.frame)));
            Some((frames(tracks)?, frames(truth)?))
        }
    }
}

fn times_meet(subject: &Subject, comparison: &Comparison) -> bool {
    if let Content::Points { input, .. } = &subject.content
        && input.recording.is_some()
    {
        // Scans may well see the one after the other; without them the clocks alone tell.
        let has_tracks = |step: &ComparedStep| !step.is_extra && !step.tracks.is_empty();
        return !comparison.truths.is_empty() && comparison.steps.iter().any(has_tracks);
    }
    comparison
        .steps
        .iter()
        .any(|step| !step.truths.is_empty() && !step.tracks.is_empty())
}

fn span(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |span, value| match span {
        None => Some((value, value)),
        Some((first, last)) => Some((f64::min(first, value), f64::max(last, value))),
    })
}

/// Numbers of boxes, of places and of directions have no common unit, so they make no number together; nor do those of two axes
/// and of three.
pub fn refuse_mixtures(subjects: &[Subject]) -> Result<(), Vec<Fault>> {
    let Some(first) = subjects.first().map(shape_name) else {
        return Ok(());
    };
    let mut faults = Vec::new();
    for (index, other) in subjects.iter().map(shape_name).enumerate() {
        if other != first {
            let detail = format!(
                "this sequence is of {other}, the first of {first}: they make no number together"
            );
            faults.push(
                Fault::new(format!("/sequences/{index}"), "conflict", detail)
                    .allowing(format!("sequences of {first}")),
            );
        }
    }
    refuse_any(faults)
}

fn shape_name(subject: &Subject) -> &'static str {
    match &subject.content {
        Content::Points { truth, .. } if !truth.space().has_places() => "directions",
        Content::Points { truth, input } => match spaces::common(truth, input.tracks) {
            Space::Volume => "points of a volume",
            _ => "points",
        },
        Content::Boxes { .. } => "boxes",
    }
}

/// A metric of metres says nothing of boxes or directions.
fn refuse_shapes(metrics: &[NamedMetric], comparisons: &[Comparison]) -> Result<(), Vec<Fault>> {
    let mut faults = Vec::new();
    for NamedMetric { name, metric, .. } in metrics {
        let mut spaces = comparisons.iter().map(|comparison| comparison.space);
        let Some(unfit) = spaces.find(|space| !metric.accepts(*space)) else {
            continue;
        };
        let (found, allowed) = match unfit {
            Some(Space::Plane | Space::Volume) => ("points", "hota, clear, identity"),
            Some(Space::Bearing) => ("directions", METRICS_OF_BEARINGS),
            None => ("boxes", "hota, clear, identity (profile vision)"),
        };
        let detail = format!("'{name}' is defined for positions in metres, not for {found}");
        faults.push(Fault::new("/metrics", "unsupported", detail).allowing(allowed));
    }
    refuse_any(faults)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::credit::Credit;
    use crate::evaluation::paths::Alignment;
    use crate::evaluation::steps::StepSettings;
    use crate::model::state::{Position, State};
    use crate::model::track::{Kinematics, Track, TrackPoint, TrackSet};
    use crate::model::truth::{Target, TruthPoint};

    /// Truth at 0 to 9 s and a track of ten seconds from `start_s` on.
    fn fault(start_s: f64) -> Option<Fault> {
        let times_s = || (0..10).map(f64::from);
        let points = times_s()
            .map(|time_s| TruthPoint::in_plane(time_s, Position::zeros(), None))
            .collect();
        let target = Target {
            truth_id: "A".to_owned(),
            points,
        };
        let truth = TruthSet::new(Space::Plane, vec![target]).unwrap();
        let point = |time_s| TrackPoint {
            height_m: None,
            time_s,
            sensor: None,
            estimate: Kinematics::of_plane(&State::zeros(), false, None),
            status: None,
            nis: None,
            known_at_s: None,
            existence: None,
            mode_row: None,
            first_candidate: 0,
            candidates: 0,
        };
        let track = Track {
            track_id: "T".to_owned(),
            points: times_s().map(|time_s| point(start_s + time_s)).collect(),
        };
        let tracks = TrackSet {
            tracks: vec![track],
            ..Default::default()
        };
        let input = EvaluationInput {
            recording: None,
            truth: Some(&truth),
            tracks: &tracks,
        };
        let alignment = Alignment::Interpolate {
            max_gap_s: Some(5.0),
        };
        let settings = PointSettings {
            alignment,
            gate_m: 10.0,
            reach_m: 10.0,
            steps: StepSettings::default(),
            credit: Credit::Afterwards,
        };
        let comparison = Comparison::of_points(&input, &truth, &settings);
        let content = Content::Points {
            input,
            truth: &truth,
        };
        disjoint_times(0, &Subject { name: "", content }, &comparison)
    }

    #[test]
    fn clocks_that_do_not_meet_are_refused_with_both_spans() {
        let found = fault(100.0).unwrap();
        assert_eq!(
            (found.pointer.as_str(), found.code.as_str()),
            ("/truth", "disjoint")
        );
        assert_eq!(
            found.detail,
            "the times of truth (0 to 9 s) and of tracks (100 to 109 s) do not meet"
        );
        assert_eq!(
            [fault(0.0), fault(6.5), fault(9.0)].map(|fault| fault.is_none()),
            [true; 3]
        );
    }
}
