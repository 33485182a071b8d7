//! What the walk notes of each truth and of each track, and the numbers that are made of it.

use crate::evaluation::metrics::{Line, Quantity};

/// The life of one truth, in steps at which it exists.
#[derive(Debug, Clone, Copy, Default)]
pub struct TruthLife {
    pub steps: u32,
    pub associated: u32,
    pub establishment: u32,
    pub breaks: u32,
    pub break_length: u32,
    pub was_associated: bool,
}

/// The life of one track, in steps at which it exists.
#[derive(Debug, Clone, Copy, Default)]
pub struct TrackLife {
    pub steps: u32,
    pub assigned: u32,
    pub swaps: u32,
    pub divergences: u32,
    pub divergence_length: u32,
    pub redundancies: u32,
    pub redundancy_length: u32,
    /// The truth it keeps, and since which step; the truth it kept last.
    pub truth: Option<u32>,
    pub since: u32,
    pub last_truth: Option<u32>,
    pub is_divergent: bool,
    pub was_redundant: bool,
}

impl TruthLife {
    pub fn quantities(&self) -> Vec<Quantity> {
        let establishment = Some(f64::from(self.establishment)).filter(|_| self.associated > 0);
        vec![
            Quantity::count("steps_inside_coverage", self.steps),
            Quantity::count("established", u32::from(self.associated > 0)),
            Quantity::or(
                "establishment_length",
                establishment,
                "steps",
                "never established",
            ),
            Quantity::count("breaks", self.breaks),
            Quantity::new("break_length", f64::from(self.break_length), "steps"),
            Quantity::ratio(
                "associated_share",
                f64::from(self.associated),
                f64::from(self.steps),
                "",
                "does not exist at any step",
            ),
        ]
    }
}

impl TrackLife {
    fn is_false(&self) -> bool {
        self.steps > 0 && self.last_truth.is_none()
    }

    pub fn quantities(&self) -> Vec<Quantity> {
        let length = |name, steps: u32| Quantity::new(name, f64::from(steps), "steps");
        vec![
            length("length", self.steps),
            length("assigned_length", self.assigned),
            Quantity::count("swaps", self.swaps),
            Quantity::count("divergences", self.divergences),
            length("divergence_length", self.divergence_length),
            Quantity::count("redundancies", self.redundancies),
            length("redundancy_length", self.redundancy_length),
            Quantity::count("false", u32::from(self.is_false())),
            length("false_length", if self.is_false() { self.steps } else { 0 }),
        ]
    }
}

pub fn lines<Life>(
    ids: &[String],
    lives: &[Life],
    quantities: impl Fn(&Life) -> Vec<Quantity>,
) -> Vec<Line> {
    ids.iter()
        .zip(lives)
        .map(|(id, life)| Line {
            id: id.clone(),
            quantities: quantities(life),
        })
        .collect()
}

pub fn totals(truths: &[TruthLife], tracks: &[TrackLife]) -> Vec<Quantity> {
    let established = sum(truths, |life| u32::from(life.associated > 0));
    let establishment = sum(truths, |life| {
        if life.associated > 0 {
            life.establishment
        } else {
            0
        }
    });
    let false_tracks = sum(tracks, |life| u32::from(life.is_false()));
    let no_truth = "no truth at any step";
    vec![
        Quantity::ratio(
            "associated_share",
            sum(truths, |life| life.associated),
            sum(truths, |life| life.steps),
            "",
            no_truth,
        ),
        Quantity::new("truths", truths.len() as f64, ""),
        Quantity::new("truths_established", established, ""),
        Quantity::ratio(
            "truths_established_share",
            established,
            truths.len() as f64,
            "",
            no_truth,
        ),
        Quantity::ratio(
            "mean_establishment_length",
            establishment,
            established,
            "steps",
            "no truth was established",
        ),
        Quantity::new("breaks", sum(truths, |life| life.breaks), ""),
        Quantity::new(
            "break_length",
            sum(truths, |life| life.break_length),
            "steps",
        ),
        Quantity::new("tracks", tracks.len() as f64, ""),
        Quantity::new("swaps", sum(tracks, |life| life.swaps), ""),
        Quantity::new("divergences", sum(tracks, |life| life.divergences), ""),
        Quantity::new(
            "divergence_length",
            sum(tracks, |life| life.divergence_length),
            "steps",
        ),
        Quantity::new("redundancies", sum(tracks, |life| life.redundancies), ""),
        Quantity::new(
            "redundancy_length",
            sum(tracks, |life| life.redundancy_length),
            "steps",
        ),
        Quantity::new("false_tracks", false_tracks, ""),
        Quantity::ratio(
            "false_tracks_share",
            false_tracks,
            tracks.len() as f64,
            "",
            "no track at any step",
        ),
        Quantity::new(
            "false_track_length",
            sum(tracks, |life| if life.is_false() { life.steps } else { 0 }),
            "steps",
        ),
    ]
}

fn sum<Life>(lives: &[Life], part: fn(&Life) -> u32) -> f64 {
    lives.iter().map(|life| f64::from(part(life))).sum()
}
