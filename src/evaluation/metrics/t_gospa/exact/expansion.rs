//! The ways in which one label may go on over one step.

use super::{ALONE, FRESH, Label, LabelSearch, MAX_SUCCESSORS, Near, is_held};

/// Method 2: all ways in which one label may take pairs of a step anew, truth by truth.
pub(super) struct Expansion<'a> {
    search: &'a LabelSearch<'a>,
    /// The near pairs of each truth that has any.
    rows: &'a [&'a [Near]],
    label: Label,
    /// Of each place: whether it was taken anew at this step.
    is_taken: Vec<bool>,
}

impl<'a> Expansion<'a> {
    pub fn new(search: &'a LabelSearch, rows: &'a [&'a [Near]], label: &Label) -> Expansion<'a> {
        let is_taken = vec![false; label.states.len()];
        let label = Label {
            new_switches: 0.0,
            ..label.clone()
        };
        Expansion {
            search,
            rows,
            label,
            is_taken,
        }
    }

    /// Decides the truths from `row` on; `improvement` is what the takings so far gain at this step beyond what they break.
    pub fn extend(&mut self, row: usize, improvement: f64, successors: &mut Vec<Label>) {
        if successors.len() > MAX_SUCCESSORS
            || self
                .search
                .watch
                .stops_after((self.rows.len() + self.is_taken.len()) as u64)
        {
            return;
        }
        let is_changed = self.is_taken.contains(&true);
        if is_changed
            && improvement
                + self.rows[row..]
                    .iter()
                    .map(|near| self.hope(near))
                    .sum::<f64>()
                <= 0.0
        {
            return;
        }
        let Some(near) = self.rows.get(row) else {
            successors.push(self.finish());
            return;
        };
        self.extend(row + 1, improvement, successors);
        for pair in *near {
            let track = self.search.truths + pair.track;
            let (truth_place, track_place) = (
                self.search.place_of[pair.truth],
                self.search.place_of[track],
            );
            if self.label.states[truth_place] == track || self.is_taken[track_place] {
                continue;
            }
            let before = self.label.clone();
            let broken = self.take(pair.truth, track);
            self.is_taken[track_place] = true;
            self.extend(row + 1, improvement + pair.gain - broken, successors);
            self.is_taken[track_place] = false;
            self.label = before;
        }
    }

    /// The most that a truth not yet decided can add to the improvement.
    fn hope(&self, near: &[Near]) -> f64 {
        let best = near.iter().map(|pair| pair.gain).fold(0.0, f64::max);
        (best - self.held_gain(near[0].truth)).max(0.0)
    }

    /// What a truth gains at this step by the track that it holds.
    fn held_gain(&self, truth: usize) -> f64 {
        let held = self.label.states[self.search.place_of[truth]];
        let row = self
            .rows
            .binary_search_by_key(&truth, |near| near[0].truth)
            .ok();
        let pair = row.and_then(|row| {
            self.rows[row]
                .iter()
                .find(|pair| self.search.truths + pair.track == held)
        });
        pair.map_or(0.0, |pair| pair.gain)
    }

    /// Gives a truth a track, breaking what both hold; returns what the broken pairs would have gained.
    fn take(&mut self, truth: usize, track: usize) -> f64 {
        let (truth_place, track_place) = (self.search.place_of[truth], self.search.place_of[track]);
        let (old_track, old_truth) = (
            self.label.states[truth_place],
            self.label.states[track_place],
        );
        let mut broken = 0.0;
        let mut halves = usize::from(old_track != FRESH || old_truth != FRESH);
        if is_held(old_track) {
            broken += self.held_gain(truth);
            halves += 1;
            self.label.states[self.search.place_of[old_track]] = ALONE;
        }
        if is_held(old_truth) {
            broken += self.held_gain(old_truth);
            halves += 1;
            self.label.states[self.search.place_of[old_truth]] = ALONE;
        }
        self.label.states[truth_place] = track;
        self.label.states[track_place] = truth;
        self.label.tally.switches += 0.5 * halves as f64;
        self.label.new_switches += 0.5 * halves as f64;
        broken
    }

    /// The label with the gains of this step.
    fn finish(&self) -> Label {
        let mut label = self.label.clone();
        for pair in self.rows.iter().copied().flatten() {
            if label.states[self.search.place_of[pair.truth]] == self.search.truths + pair.track {
                label.tally.gain += pair.gain;
                label.tally.matched += 1.0;
            }
        }
        label.cost = label.tally.cost(self.search.penalty);
        label
    }
}
