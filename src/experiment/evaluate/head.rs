//! What a reader must know of an evaluation before its numbers: whose times count, what is a match, and what was left out.

use super::compare::{Content, Subject};
use super::spec::ComparisonSpec;
use crate::evaluation::comparison::Comparison;
use crate::evaluation::credit::Credit;
use crate::evaluation::paths::Alignment;
use crate::evaluation::scope::LeftOut;
use serde::Serialize;

/// How truth and tracks were put side by side.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct Compared {
    /// In words, whose times the steps are.
    pub steps: String,
    /// The usual time between two steps, where there is one.
    pub period_s: Option<f64>,
    pub step_count: usize,
    /// Steps at which a target is due: means are over these.
    pub due_steps: usize,
    /// Steps that fill holes of the recording.
    pub filled_steps: usize,
    /// Steps of tracks alone, at which no target is due.
    pub extra_steps: usize,
    /// Points of tracks that were not compared: others of their track are nearer to the step.
    pub points_between_steps: usize,
    /// `at_the_time` or `afterwards`: whether the first points of a track count that was known later.
    pub credit: &'static str,
    /// Points that are not credited: the track was not known then.
    pub points_not_known_then: usize,
    /// Points of the truth outside `within`, of which nothing is due.
    pub truth_points_left_out: usize,
    /// Points of tracks outside `within`, or on targets there.
    pub track_points_left_out: usize,
    /// `interpolate` or `nearest`; absent of boxes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alignment: Option<&'static str>,
    /// Largest gap in the truth that is bridged; absent where it is 2.5 times the median time between two points of a target.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_gap_s: Option<f64>,
    /// Largest distance of a match.
    pub gate: f64,
    /// `m`, `deg`, or empty of boxes, whose distance is 1 − intersection over union.
    pub gate_unit: &'static str,
}

pub fn compared(
    spec: &ComparisonSpec,
    left_out: LeftOut,
    subjects: &[Subject],
    comparisons: &[Comparison],
) -> Option<Compared> {
    let first = comparisons.first()?;
    let is_of_boxes = matches!(subjects.first()?.content, Content::Boxes { .. });
    let rule = spec.alignment.rule;
    let alignment = match rule {
        Alignment::Interpolate { .. } => "interpolate",
        Alignment::Nearest { .. } => "nearest",
    };
    let facts = || comparisons.iter().map(|comparison| comparison.facts);
    let mut made_of: Vec<&str> = facts().map(|facts| facts.made_of).collect();
    made_of.sort_unstable();
    made_of.dedup();
    let steps = comparisons.iter().flat_map(|comparison| &comparison.steps);
    let gate_unit = match first.space {
        None => "",
        Some(_) if first.is_in_metres() => "m",
        Some(_) => "deg",
    };
    Some(Compared {
        steps: if is_of_boxes {
            "frames".to_owned()
        } else {
            made_of.join("; ")
        },
        period_s: first.facts.period_s,
        step_count: steps.clone().count(),
        due_steps: comparisons.iter().map(Comparison::due_steps).sum(),
        filled_steps: facts().map(|facts| facts.filled).sum(),
        extra_steps: steps.filter(|step| step.is_extra).count(),
        points_between_steps: facts().map(|facts| facts.between_steps).sum(),
        credit: match spec.credit() {
            Credit::AtTheTime => "at_the_time",
            Credit::Afterwards => "afterwards",
        },
        truth_points_left_out: left_out.truth_points,
        track_points_left_out: left_out.track_points,
        points_not_known_then: facts().map(|facts| facts.unknown_then).sum(),
        alignment: (!is_of_boxes).then_some(alignment),
        max_gap_s: rule.max_gap_s().filter(|_| !is_of_boxes),
        gate: first.gate,
        gate_unit,
    })
}
