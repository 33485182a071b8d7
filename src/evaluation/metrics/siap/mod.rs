//! SIAP: six questions of an air picture. Is every target tracked, by one track each, without spare tracks, how
//! accurately, how often does its track number change, and how long does one number last?
//!
//! # Reference
//! P. Votruba, R. Nisley, R. Rothrock, B. Zombro, Single Integrated Air Picture (SIAP) Metrics Implementation, SIAP System
//! Engineering Task Force, 2001.
//!
//! # Method
//! 1. Which track follows which target when: see [`following`]. Several tracks may follow one target.
//! 2. Over all steps: completeness is tracked targets of targets, ambiguity following tracks of tracked targets,
//!    spuriousness not following tracks of tracks; position and velocity accuracy are mean errors of following tracks.
//! 3. Rate of track number changes: changes of tracked time. A target's numbers are as few following pieces as cover its
//!    tracked times; the same track again is no change.
//! 4. Longest segment: the longest unbroken piece of one track, of the target's life; over targets, sums of both. A piece ends
//!    where the track is not there.
//! 5. `siap_compat: stonesoup` counts as Stone Soup does: a distance equal to the gate is no match, the same track again is
//!    a change, and pieces of one track add up to a segment.

mod following;
mod numbers;

use self::following::{Following, follow};
use self::numbers::{Numbers, numbers};
use super::origin::{Origin, PAIRS, PairColumn, Statistic, TRACK_POINTS, TRUTH_POINTS, TRUTHS};
use super::{BuildMetric, Line, Metric, MetricReport, Quantity, Sequence, Series};
use crate::evaluation::comparison::{ComparedStep, Comparison, Presence};
use crate::model::space::Space;
use crate::registry::{Kind, Method, Object, default, whole};
use serde::Deserialize;
use serde_json::{Value, json};

pub const METHOD: Method<BuildMetric> = Method {
    name: "siap",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(Siap(SiapSettings::deserialize(spec)?))),
};

static PARAMETERS: Object = Object {
    name: "Siap",
    summary: "Completeness, ambiguity, spuriousness, accuracy and continuity of the picture.",
    fields: &[
        default(
            "confirm_steps",
            "Steps in a row in which a target must be a track's nearest within the gate, for the track to follow it.",
            whole(1, 1000, ""),
            "3",
        ),
        default(
            "end_steps",
            "Steps in a row in which it is not, for the track to follow it no longer.",
            whole(1, 1000, ""),
            "2",
        ),
        default(
            "siap_compat",
            "none: distances up to the gate match, segments are unbroken. stonesoup: counts as Stone Soup does.",
            Kind::Choice(&["none", "stonesoup"]),
            "\"none\"",
        ),
    ],
};

#[derive(Debug, Clone, Copy, Deserialize)]
struct SiapSettings {
    confirm_steps: u32,
    end_steps: u32,
    siap_compat: Compat,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Compat {
    None,
    StoneSoup,
}

struct Siap(SiapSettings);

/// Step 2, of one step or summed.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    targets: f64,
    tracked: f64,
    tracks: f64,
    following: f64,
    position_m: f64,
    /// Following tracks whose velocity and whose target's velocity are known.
    with_velocity: f64,
    velocity_mps: f64,
}

impl Metric for Siap {
    fn accepts(&self, space: Option<Space>) -> bool {
        space.is_some_and(Space::has_places)
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let mut steps = Vec::new();
        let mut all = Vec::new();
        let (mut per_truth, mut per_track, mut pairs) = (Vec::new(), Vec::new(), Vec::new());
        for comparison in sequences.iter().map(|sequence| sequence.comparison) {
            let following = follow(comparison, &self.0);
            steps.extend(
                comparison
                    .steps
                    .iter()
                    .map(|step| Counts::at_step(comparison, step, &following)),
            );
            pairs = pair_columns(comparison, &following);
            let truths = numbers(comparison, &following, self.0.siap_compat);
            per_truth.extend(
                comparison
                    .truth_ids
                    .iter()
                    .zip(&truths)
                    .map(|(id, numbers)| truth_line(id, numbers)),
            );
            per_track.extend(track_lines(comparison, &following));
            all.extend(truths);
        }
        let mut quantities = Counts::sum(&steps).quantities().to_vec();
        quantities.extend(continuity(&all));
        let mut report =
            MetricReport::new("completeness", true, self.parameters(sequences), quantities);
        report.origins = FROM.to_vec();
        if sequences.len() == 1 {
            (report.per_truth, report.per_track, report.pairs) = (per_truth, per_track, pairs);
            report.series = series(&steps);
        }
        report
    }
}

const FROM: &[Origin] = &[
    TRUTH_POINTS,
    TRACK_POINTS,
    Origin::rows("tracked", Statistic::Count, PAIRS, "tracked"),
    Origin::rows("following", Statistic::Count, PAIRS, "position_error"),
    Origin::ratio("completeness", &["tracked"], &["truth_points"]),
    Origin::ratio("ambiguity", &["following"], &["tracked"]),
    Origin::ratio(
        "spuriousness",
        &["track_points", "-following"],
        &["track_points"],
    ),
    Origin::rows(
        "position_accuracy",
        Statistic::Mean,
        PAIRS,
        "position_error",
    ),
    Origin::rows(
        "velocity_accuracy",
        Statistic::Mean,
        PAIRS,
        "velocity_error",
    ),
    Origin::sum("track_number_changes", TRUTHS),
    Origin::sum("tracked_time", TRUTHS),
    Origin::ratio(
        "track_number_change_rate",
        &["track_number_changes"],
        &["tracked_time"],
    ),
    Origin::sum("longest_segment_time", TRUTHS),
    Origin::sum("life_time", TRUTHS),
    Origin::ratio("longest_segment", &["longest_segment_time"], &["life_time"]),
];

impl Siap {
    fn parameters(&self, sequences: &[Sequence]) -> Value {
        let compat = if self.0.siap_compat == Compat::None {
            "none"
        } else {
            "stonesoup"
        };
        json!({
            "gate_m": sequences.first().map(|sequence| sequence.comparison.gate),
            "confirm_steps": self.0.confirm_steps,
            "end_steps": self.0.end_steps,
            "siap_compat": compat,
        })
    }
}

impl Counts {
    fn at_step(comparison: &Comparison, step: &ComparedStep, following: &Following) -> Counts {
        let truths = &comparison.truths[step.truths.clone()];
        let mut counts = Counts {
            targets: truths.len() as f64,
            tracks: step.tracks.len() as f64,
            ..Counts::default()
        };
        for_each_following(comparison, step, following, |truth, track, is_first| {
            counts.tracked += f64::from(u8::from(is_first));
            counts.following += 1.0;
            let (truth, track) = beside(comparison, truth, track);
            counts.position_m += position_error_m(&truth, &track);
            if let Some(error_mps) = velocity_error_mps(&truth, &track) {
                counts.with_velocity += 1.0;
                counts.velocity_mps += error_mps;
            }
        });
        counts
    }

    fn sum(steps: &[Counts]) -> Counts {
        steps.iter().fold(Counts::default(), |sum, step| Counts {
            targets: sum.targets + step.targets,
            tracked: sum.tracked + step.tracked,
            tracks: sum.tracks + step.tracks,
            following: sum.following + step.following,
            position_m: sum.position_m + step.position_m,
            with_velocity: sum.with_velocity + step.with_velocity,
            velocity_mps: sum.velocity_mps + step.velocity_mps,
        })
    }

    fn quantities(&self) -> [Quantity; 5] {
        [
            Quantity::ratio(
                "completeness",
                self.tracked,
                self.targets,
                "",
                "there is no target",
            ),
            Quantity::ratio(
                "ambiguity",
                self.following,
                self.tracked,
                "",
                "no target is tracked",
            ),
            Quantity::ratio(
                "spuriousness",
                self.tracks - self.following,
                self.tracks,
                "",
                "there is no track",
            ),
            Quantity::ratio(
                "position_accuracy",
                self.position_m,
                self.following,
                "m",
                "no track follows a target",
            ),
            Quantity::ratio(
                "velocity_accuracy",
                self.velocity_mps,
                self.with_velocity,
                "m/s",
                "no track with a velocity follows a target with one",
            ),
        ]
    }
}

/// Calls back with each target and track at a step of which the track follows the target, by their indices in the
/// comparison, and whether it is the first track of that target.
fn for_each_following(
    comparison: &Comparison,
    step: &ComparedStep,
    following: &Following,
    mut found: impl FnMut(usize, usize, bool),
) {
    let truths = &comparison.truths[step.truths.clone()];
    let mut is_tracked = vec![false; truths.len()];
    for index in step.tracks.clone() {
        let Some(truth) = following.truth_of[index] else {
            continue;
        };
        let Ok(place) = truths.binary_search_by_key(&truth, |presence| presence.id) else {
            continue;
        };
        found(
            step.truths.start + place,
            index,
            !std::mem::replace(&mut is_tracked[place], true),
        );
    }
}

/// A truth and a track of one step, both at the time of the track.
fn beside(comparison: &Comparison, truth: usize, track: usize) -> (Presence, Presence) {
    (
        comparison.truth_beside(truth, track),
        comparison.tracks[track],
    )
}

fn position_error_m(truth: &Presence, track: &Presence) -> f64 {
    (track.position_m - truth.position_m).norm()
}

/// `None` where either velocity is unknown.
fn velocity_error_mps(truth: &Presence, track: &Presence) -> Option<f64> {
    Some((track.velocity_mps()? - truth.velocity_mps()?).norm())
}

/// The errors of every following track, and which of them is the one by which its target counts as tracked.
fn pair_columns(comparison: &Comparison, following: &Following) -> Vec<PairColumn> {
    let (mut tracked, mut position, mut velocity) = (Vec::new(), Vec::new(), Vec::new());
    for step in &comparison.steps {
        for_each_following(
            comparison,
            step,
            following,
            |truth_place, track_place, is_first| {
                let (truth, track) = beside(comparison, truth_place, track_place);
                let cell = |value: f64| (truth_place as u32, track_place as u32, value);
                tracked.extend(is_first.then(|| cell(1.0)));
                position.push(cell(position_error_m(&truth, &track)));
                velocity.extend(velocity_error_mps(&truth, &track).map(cell));
            },
        );
    }
    vec![
        PairColumn::new("position_error", "m", position),
        PairColumn::new("velocity_error", "m/s", velocity),
        PairColumn::new("tracked", "", tracked),
    ]
}

/// Steps 3 and 4 over targets.
fn continuity(truths: &[Numbers]) -> [Quantity; 2] {
    let sum = |of: fn(&Numbers) -> f64| truths.iter().map(of).sum::<f64>();
    [
        Quantity::ratio(
            "track_number_change_rate",
            sum(|numbers| numbers.changes as f64),
            sum(|numbers| numbers.tracked_s),
            "1/s",
            "no target is tracked over time",
        ),
        Quantity::ratio(
            "longest_segment",
            sum(|numbers| numbers.longest_s),
            sum(|numbers| numbers.life_s),
            "",
            "no target lives over time",
        ),
    ]
}

fn truth_line(id: &str, numbers: &Numbers) -> Line {
    let quantities = vec![
        Quantity::ratio(
            "completeness",
            numbers.tracked_steps as f64,
            numbers.steps as f64,
            "",
            "the target exists at no step",
        ),
        Quantity::new("track_number_changes", numbers.changes as f64, ""),
        Quantity::new("tracked_time", numbers.tracked_s, "s"),
        Quantity::ratio(
            "longest_segment",
            numbers.longest_s,
            numbers.life_s,
            "",
            "the target exists at fewer than two steps",
        ),
        Quantity::new("longest_segment_time", numbers.longest_s, "s"),
        Quantity::new("life_time", numbers.life_s, "s"),
    ];
    Line {
        id: id.to_owned(),
        quantities,
    }
}

fn track_lines(comparison: &Comparison, following: &Following) -> Vec<Line> {
    let mut counts = vec![(0.0, 0.0); comparison.track_ids.len()];
    for (presence, truth) in comparison.tracks.iter().zip(&following.truth_of) {
        let (steps, follows) = &mut counts[presence.id as usize];
        *steps += 1.0;
        *follows += f64::from(u8::from(truth.is_some()));
    }
    let line = |(id, &(steps, follows)): (&String, &(f64, f64))| {
        let share = Quantity::ratio(
            "following",
            follows,
            steps,
            "",
            "the track exists at no step",
        );
        Line {
            id: id.clone(),
            quantities: vec![share],
        }
    };
    comparison.track_ids.iter().zip(&counts).map(line).collect()
}

fn series(steps: &[Counts]) -> Vec<Series> {
    let quantities: Vec<[Quantity; 5]> = steps.iter().map(Counts::quantities).collect();
    let of = |place: usize| {
        let head = Counts::default().quantities()[place].clone();
        Series::over_time(
            head.name,
            head.unit,
            quantities.iter().map(|step| step[place].value),
        )
    };
    (0..5).map(of).collect()
}
