//! T-GOSPA of a cluster exactly: dynamic programming over the steps, with only those assignments in memory that may still
//! turn out best.
//!
//! # Symbols
//! A *label* is an assignment at a step with the least that leads to it. A member is *fresh* until it is first assigned.
//!
//! # Method
//! 1. A pair is held until one of the two is given to another: letting go earlier or taking hold before there is a gain is
//!    never better, except from the very start. So a first hold of two fresh members is no switch.
//! 2. At each step a label may take any of the step's pairs anew. Taking and breaking cost half a switch each. Takings that
//!    gain less at the step than what they break are left out: the label unchanged can catch up with them later.
//! 3. A label is dropped when another, with the switches from it added, costs no more.
//! 4. Members meet in groups: groups that share a near pair are merged (their labels multiply), and members on whose state
//!    all labels agree leave. So doubt about one place does not multiply with doubt about another.
//! 5. A settled pair is a group of two that hold each other; near, it is *sure* to gain. So is a pair of two without a group
//!    that are nearest to each other, if they gain more than 1.5 switches: the most that not taking each other could save.
//! 6. A near pair between groups is left out when it gains no more than the halves that the sure pairs at its ends have of
//!    theirs: whatever takes such pairs breaks sure ones that gain as much. Where a sure pair is merged, it is not sure.
//!
//! It gives up when labels or the work of comparing them grow beyond bounds.

mod expansion;

use super::problem::{Cluster, Near, Solution, Tally};
use super::trace::{NO_TRACE, Traces};
use crate::model::watch::Watch;
use expansion::Expansion;
use std::collections::BTreeMap;

/// Most labels of a group, most labels that one step may make of them, most comparisons of labels in a cluster.
const MAX_LABELS: usize = 512;
const MAX_SUCCESSORS: usize = 8192;
const MAX_COMPARISONS: usize = 20_000_000;

/// States of a member that is not held by a partner.
const FRESH: usize = usize::MAX;
const ALONE: usize = usize::MAX - 1;

/// The least cost with its parts; `None` when the doubts are too many, or the watch says to stop.
pub fn solve(cluster: &Cluster, penalty: f64, watch: &Watch) -> Option<Solution> {
    let mut search = LabelSearch::new(cluster, penalty, watch);
    for step in &cluster.steps {
        search.step(step)?;
    }
    let mut solution = search.settled;
    for group in search.groups.into_iter().flatten() {
        if let Some(best) = group
            .labels
            .into_iter()
            .min_by(|one, other| one.cost.total_cmp(&other.cost))
        {
            solution.tally += best.tally;
            search.traces.tell(best.trace, &mut solution);
        }
    }
    Some(solution)
}

#[derive(Debug, Clone)]
struct Label {
    tally: Tally,
    cost: f64,
    /// Of each member of the group: its partner, [`ALONE`] or [`FRESH`]. Tracks are numbered on from the truths.
    states: Vec<usize>,
    /// What it assigned and switched so far, if that is not settled.
    trace: usize,
    /// Switches of this step alone.
    new_switches: f64,
}

impl Label {
    fn of_states(states: Vec<usize>) -> Label {
        Label {
            tally: Tally::default(),
            cost: 0.0,
            states,
            trace: NO_TRACE,
            new_switches: 0.0,
        }
    }
}

#[derive(Debug)]
struct Group {
    members: Vec<usize>,
    labels: Vec<Label>,
}

struct LabelSearch<'w> {
    watch: &'w Watch<'w>,
    truths: usize,
    penalty: f64,
    /// By a number that [`LabelSearch::group_of`] refers to.
    groups: Vec<Option<Group>>,
    group_of: Vec<usize>,
    /// Place of each member in its group.
    place_of: Vec<usize>,
    /// Of each member of a sure pair of this step its half of what the pair gains for certain, else 0.
    worth: Vec<f64>,
    /// Of each of them the other one.
    partner: Vec<usize>,
    settled: Solution,
    traces: Traces,
    comparisons: usize,
}

fn is_held(state: usize) -> bool {
    state < ALONE
}

impl<'w> LabelSearch<'w> {
    fn new(cluster: &Cluster, penalty: f64, watch: &'w Watch<'w>) -> Self {
        let members = cluster.truths + cluster.tracks;
        let mut search = LabelSearch {
            watch,
            truths: cluster.truths,
            penalty,
            groups: (0..members).map(|_| None).collect(),
            group_of: vec![0; members],
            place_of: vec![0; members],
            worth: vec![0.0; members],
            partner: (0..members).collect(),
            settled: Solution::default(),
            traces: Traces::default(),
            comparisons: 0,
        };
        for member in 0..members {
            search.store(vec![member], vec![Label::of_states(vec![FRESH])]);
        }
        search
    }

    /// Keeps a group under the number of its first member.
    fn store(&mut self, members: Vec<usize>, labels: Vec<Label>) {
        let Some(&number) = members.first() else {
            return;
        };
        for (place, &member) in members.iter().enumerate() {
            (self.group_of[member], self.place_of[member]) = (number, place);
        }
        self.groups[number] = Some(Group { members, labels });
    }

    fn step(&mut self, near: &[Near]) -> Option<()> {
        self.meet(near)?;
        let mut of_group: BTreeMap<usize, Vec<Near>> = BTreeMap::new();
        for pair in near {
            let track = self.truths + pair.track;
            if self.is_sure(pair) {
                self.keep(pair);
            } else if self.group_of[pair.truth] == self.group_of[track] {
                of_group
                    .entry(self.group_of[track])
                    .or_default()
                    .push(*pair);
            }
        }
        for pair in near {
            (self.worth[pair.truth], self.worth[self.truths + pair.track]) = (0.0, 0.0);
        }
        of_group
            .into_iter()
            .try_for_each(|(number, near)| self.advance(number, &near))
    }

    /// Methods 4 to 6: merges the groups that have to be looked at together.
    fn meet(&mut self, near: &[Near]) -> Option<()> {
        for pair in near {
            if self.is_settled(pair) {
                self.set_worth(pair, 0.5 * pair.gain);
            }
        }
        self.meet_singles(near);
        loop {
            let mut has_met = false;
            self.go_on(16 * near.len())?;
            for pair in near {
                let track = self.truths + pair.track;
                let is_left_out =
                    self.is_sure(pair) || pair.gain <= self.worth[pair.truth] + self.worth[track];
                if is_left_out || self.group_of[pair.truth] == self.group_of[track] {
                    continue;
                }
                self.merge(self.group_of[pair.truth], self.group_of[track])?;
                has_met = true;
            }
            if !has_met {
                return Some(());
            }
        }
    }

    /// Counts work in so many pieces; `None` when it is to stop.
    fn go_on(&self, pieces: usize) -> Option<()> {
        (!self.watch.stops_after(pieces as u64)).then_some(())
    }

    /// Method 5, second half.
    fn meet_singles(&mut self, near: &[Near]) {
        let mut best: BTreeMap<usize, Near> = BTreeMap::new();
        for pair in near {
            for member in [pair.truth, self.truths + pair.track] {
                let best = best.entry(member).or_insert(*pair);
                if pair.gain > best.gain {
                    *best = *pair;
                }
            }
        }
        for pair in near {
            let ends = [pair.truth, self.truths + pair.track];
            let worth = 0.5 * (pair.gain - 1.5 * self.penalty);
            if worth > 0.0
                && ends
                    .iter()
                    .all(|end| best.get(end) == Some(pair) && self.single_state(*end).is_some())
            {
                self.set_worth(pair, worth);
            }
        }
    }

    /// The state of a member that is a group by itself.
    fn single_state(&self, member: usize) -> Option<usize> {
        let group = self.groups[self.group_of[member]].as_ref()?;
        (group.members.len() == 1).then(|| group.labels[0].states[0])
    }

    fn set_worth(&mut self, pair: &Near, worth: f64) {
        (self.worth[pair.truth], self.worth[self.truths + pair.track]) = (worth, worth);
        (
            self.partner[pair.truth],
            self.partner[self.truths + pair.track],
        ) = (self.truths + pair.track, pair.truth);
    }

    fn is_sure(&self, pair: &Near) -> bool {
        self.worth[pair.truth] > 0.0 && self.partner[pair.truth] == self.truths + pair.track
    }

    /// Counts a sure pair; two singles become a settled pair by it.
    fn keep(&mut self, near: &Near) {
        let (truth, track) = (near.truth, self.truths + near.track);
        self.settled.tally += Tally {
            gain: near.gain,
            matched: 1.0,
            switches: 0.0,
        };
        self.settled.shares.push((near.pair, 1.0));
        if let (Some(one), Some(other)) = (self.single_state(truth), self.single_state(track)) {
            if one != FRESH || other != FRESH {
                self.settled.tally.switches += 0.5;
                self.settled.switches.push((near.pair, 0.5));
            }
            self.groups[self.group_of[track]] = None;
            self.store(
                vec![truth, track],
                vec![Label::of_states(vec![track, truth])],
            );
        }
    }

    /// Whether it is sure that these two hold each other.
    fn is_settled(&self, pair: &Near) -> bool {
        let group = self.groups[self.group_of[pair.truth]].as_ref();
        let states = group
            .filter(|group| group.members.len() == 2 && group.labels.len() == 1)
            .map(|group| &group.labels[0].states);
        states.is_some_and(|states| states[self.place_of[pair.truth]] == self.truths + pair.track)
    }

    /// Takes a group over a step.
    fn advance(&mut self, number: usize, near: &[Near]) -> Option<()> {
        let group = self.groups[number].take()?;
        let rows: Vec<&[Near]> = near
            .chunk_by(|one, other| one.truth == other.truth)
            .collect();
        let mut successors = Vec::new();
        for label in &group.labels {
            Expansion::new(self, &rows, label).extend(0, 0.0, &mut successors);
            if successors.len() > MAX_SUCCESSORS {
                return None;
            }
            self.go_on(64)?;
        }
        let mut labels = self.drop_dominated(&group.members, successors)?;
        for label in &mut labels {
            let is_held =
                |pair: &&Near| label.states[self.place_of[pair.truth]] == self.truths + pair.track;
            let assigned = near.iter().filter(is_held).map(|pair| pair.pair).collect();
            label.trace =
                self.traces
                    .go_on(label.trace, near[0].pair, assigned, label.new_switches);
        }
        self.split(group.members, labels);
        Some(())
    }

    /// Method 4, first half.
    fn merge(&mut self, one: usize, other: usize) -> Option<()> {
        if one == other {
            return Some(());
        }
        let (one, other) = (self.groups[one].take()?, self.groups[other].take()?);
        if one.labels.len() * other.labels.len() > MAX_LABELS {
            return None;
        }
        self.go_on(
            one.labels.len() * other.labels.len() * (one.members.len() + other.members.len()),
        )?;
        let mut labels = Vec::with_capacity(one.labels.len() * other.labels.len());
        for (left, right) in one
            .labels
            .iter()
            .flat_map(|left| other.labels.iter().map(move |right| (left, right)))
        {
            let mut tally = left.tally;
            tally += right.tally;
            let states = left.states.iter().chain(&right.states).copied().collect();
            let trace = self.traces.join(left.trace, right.trace);
            labels.push(Label {
                tally,
                cost: tally.cost(self.penalty),
                states,
                trace,
                new_switches: 0.0,
            });
        }
        for &member in one.members.iter().chain(&other.members) {
            (self.worth[member], self.worth[self.partner[member]]) = (0.0, 0.0);
        }
        self.store(
            one.members.into_iter().chain(other.members).collect(),
            labels,
        );
        Some(())
    }

    /// Method 3: from the cheapest on, those that no cheaper one reaches.
    fn drop_dominated(&mut self, members: &[usize], mut labels: Vec<Label>) -> Option<Vec<Label>> {
        labels.sort_by(|one, other| {
            one.cost
                .total_cmp(&other.cost)
                .then_with(|| one.states.cmp(&other.states))
        });
        let mut kept: Vec<Label> = Vec::new();
        for label in labels {
            self.comparisons += kept.len();
            self.go_on(2 * kept.len() * members.len())?;
            let reaches = |cheaper: &Label| {
                cheaper.states == label.states
                    || cheaper.cost + self.penalty * self.switches(members, cheaper, &label)
                        <= label.cost
            };
            if !kept.iter().any(reaches) {
                kept.push(label);
            }
        }
        (kept.len() <= MAX_LABELS && self.comparisons <= MAX_COMPARISONS).then_some(kept)
    }

    /// At most so many switches does it take to go on from one label as if from another.
    fn switches(&self, members: &[usize], from: &Label, to: &Label) -> f64 {
        let mut halves = 0;
        for ((&member, &left), &right) in members.iter().zip(&from.states).zip(&to.states) {
            if left == right {
                continue;
            }
            // Each pair is counted at its truth.
            if member < self.truths {
                let is_first =
                    is_held(right) && left == FRESH && from.states[self.place_of[right]] == FRESH;
                halves += usize::from(is_held(left)) + usize::from(is_held(right) && !is_first);
            }
            halves += usize::from(right == FRESH);
        }
        0.5 * halves as f64
    }

    /// Method 4, second half.
    fn split(&mut self, members: Vec<usize>, mut labels: Vec<Label>) {
        if let [label] = &mut labels[..] {
            self.settled.tally += std::mem::take(&mut label.tally);
            label.cost = 0.0;
            self.traces.tell(
                std::mem::replace(&mut label.trace, NO_TRACE),
                &mut self.settled,
            );
        }
        let agreed: Vec<Option<usize>> = (0..members.len())
            .map(|place| {
                let state = labels[0].states[place];
                labels
                    .iter()
                    .all(|label| label.states[place] == state)
                    .then_some(state)
            })
            .collect();
        let single = |states| vec![Label::of_states(states)];
        for (&member, state) in members.iter().zip(&agreed) {
            match *state {
                Some(partner) if is_held(partner) && member < partner => {
                    self.store(vec![member, partner], single(vec![partner, member]))
                }
                Some(state) if !is_held(state) => self.store(vec![member], single(vec![state])),
                _ => {}
            }
        }
        for label in &mut labels {
            label.states = label
                .states
                .iter()
                .zip(&agreed)
                .filter(|(_, agreed)| agreed.is_none())
                .map(|(&state, _)| state)
                .collect();
        }
        self.store(
            members
                .into_iter()
                .zip(&agreed)
                .filter(|(_, agreed)| agreed.is_none())
                .map(|(member, _)| member)
                .collect(),
            labels,
        );
    }
}
