//! In which order the exact sum takes the elements of one side, and what it must remember between two of them: the
//! frontier, those nodes of the other side that an earlier element may have used and a later one may still want.
//!
//! # Method
//! 1. Start at the element with the fewest edges.
//! 2. Next comes the element, among those that want a node of the frontier, that leaves the smallest frontier; of
//!    equals, the one that brings the fewest new nodes, then the first.
//! 3. A table over the subsets of the frontier doubles with each new node and halves with each that nobody wants any
//!    more, so the sizes of all tables are known before any is computed.

use super::cluster::Sides;

/// One choice of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice {
    pub(super) edge: u32,
    /// Bit of the node in the frontier of this step; [`PRIVATE`] when no other element wants it.
    pub(super) bit: u8,
}

/// The bit of a node that only one element wants: whether it is used matters to nobody else.
pub(super) const PRIVATE: u8 = u8::MAX;

/// One element of the order.
#[derive(Debug, Clone, Copy)]
pub(super) struct EliminationStep {
    pub(super) element: u32,
    /// Nodes in the frontier before this element.
    pub(super) width: u32,
    /// Nodes that enter with it, as the bits from `width` on.
    pub(super) fresh: u32,
    /// Ends of this step's parts of [`EliminationPlan::choices`] and [`EliminationPlan::leaving`].
    pub(super) choices_end: u32,
    pub(super) leaving_end: u32,
}

#[derive(Debug, Clone, Default)]
pub(super) struct EliminationPlan {
    pub(super) steps: Vec<EliminationStep>,
    pub(super) choices: Vec<Choice>,
    /// Bits that leave after each step, highest first.
    pub(super) leaving: Vec<u8>,
    /// Cells to be visited, over all steps and choices.
    pub(super) cost: u64,
    /// The widest frontier.
    pub(super) frontier: u32,
    /// For each node of the other side, how many elements to come want it.
    wanted: Vec<u32>,
    /// Exclusive or of their numbers: of the last one, its number.
    wanted_by: Vec<u32>,
    /// For each node of the other side, its bit.
    bit_of: Vec<u8>,
    /// Nodes in the frontier, by bit.
    frontier_nodes: Vec<u32>,
    /// Elements to come that want a node of the frontier.
    fringe: Vec<u32>,
    state: Vec<Seen>,
    /// For each element to come, what it would do to the frontier.
    effects: Vec<Effect>,
}

/// What taking an element does to the frontier; the smaller, the better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Effect {
    /// Nodes that enter less nodes that leave.
    growth: i32,
    /// Nodes that enter.
    fresh: i32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    No,
    Fringe,
    Taken,
}

const ABSENT: u8 = u8::MAX;

/// What a plan may cost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Nodes of a frontier.
    pub(super) width: u32,
    /// Cells visited, over all steps.
    pub(super) cost: u64,
}

/// No order costs less: every element's table has at least the nodes that others want, too.
pub(super) fn least_cost(sides: Sides) -> u64 {
    let cost = |element: usize| {
        (sides.elements.edges_of(element).len() as u64 + 2) << sides.shared_nodes(element).min(40)
    };
    (0..sides.elements.len())
        .map(cost)
        .fold(0, u64::saturating_add)
}

impl EliminationPlan {
    /// Finds the order; false when it would break a limit.
    pub(super) fn make(&mut self, sides: Sides, limits: Limits) -> bool {
        self.reset(sides);
        let degree = |element: &usize| sides.elements.edges_of(*element).len();
        let mut next = (0..sides.elements.len()).min_by_key(degree);
        while let Some(element) = next {
            if !self.take(sides, element as u32, limits) {
                return false;
            }
            next = self
                .fringe
                .iter()
                .min_by_key(|&&element| (self.effects[element as usize], element))
                .map(|&element| element as usize);
        }
        true
    }

    fn reset(&mut self, sides: Sides) {
        self.steps.clear();
        self.choices.clear();
        self.leaving.clear();
        self.frontier_nodes.clear();
        self.fringe.clear();
        (self.cost, self.frontier) = (0, 0);
        self.wanted.clear();
        self.wanted
            .extend((0..sides.others.len()).map(|node| sides.others.edges_of(node).len() as u32));
        self.bit_of.clear();
        self.bit_of.resize(sides.others.len(), ABSENT);
        self.state.clear();
        self.state.resize(sides.elements.len(), Seen::No);
        let wanted_by = |node| {
            sides
                .others
                .edges_of(node)
                .iter()
                .fold(0, |all, &edge| all ^ sides.element_of[edge as usize])
        };
        self.wanted_by.clear();
        self.wanted_by
            .extend((0..sides.others.len()).map(wanted_by));
        self.effects.clear();
        self.effects
            .extend((0..sides.elements.len()).map(|element| {
                let fresh = sides.shared_nodes(element) as i32;
                Effect {
                    growth: fresh,
                    fresh,
                }
            }));
    }

    /// Adds the step of an element; false when it would break a limit.
    fn take(&mut self, sides: Sides, element: u32, limits: Limits) -> bool {
        let edges = sides.elements.edges_of(element as usize);
        let width = self.frontier_nodes.len() as u32;
        self.state[element as usize] = Seen::Taken;
        self.fringe.retain(|&other| other != element);
        for &edge in edges {
            let node = sides.other_of[edge as usize];
            let bit = self.use_node(sides, element, node);
            self.choices.push(Choice { edge, bit });
        }
        let full = self.frontier_nodes.len() as u32;
        self.frontier = self.frontier.max(full);
        if full > limits.width {
            return false;
        }
        self.cost += (edges.len() as u64 + 2) << full;
        self.leave();
        let (choices_end, leaving_end) = (self.choices.len() as u32, self.leaving.len() as u32);
        self.steps.push(EliminationStep {
            element,
            width,
            fresh: full - width,
            choices_end,
            leaving_end,
        });
        self.cost <= limits.cost
    }

    /// An element that wants a node is taken: the bit of the node, which is in the frontier from now on unless nobody else
    /// wants it.
    fn use_node(&mut self, sides: Sides, element: u32, node: u32) -> u8 {
        let place = node as usize;
        self.wanted[place] -= 1;
        self.wanted_by[place] ^= element;
        if self.bit_of[place] == ABSENT {
            if self.wanted[place] == 0 {
                return PRIVATE;
            }
            self.enter(sides, node);
        }
        if self.wanted[place] == 1 {
            self.effects[self.wanted_by[place] as usize].growth -= 1;
        }
        self.bit_of[place]
    }

    /// A node enters the frontier: to others that want it, it is not new any more, and they are in the fringe.
    fn enter(&mut self, sides: Sides, node: u32) {
        self.bit_of[node as usize] = self.frontier_nodes.len().min(usize::from(ABSENT) - 1) as u8;
        self.frontier_nodes.push(node);
        for &edge in sides.others.edges_of(node as usize) {
            let other = sides.element_of[edge as usize];
            let effect = &mut self.effects[other as usize];
            *effect = Effect {
                growth: effect.growth - 1,
                fresh: effect.fresh - 1,
            };
            if self.state[other as usize] == Seen::No {
                self.state[other as usize] = Seen::Fringe;
                self.fringe.push(other);
            }
        }
    }

    /// Takes the nodes that nobody wants any more out of the frontier; the bits above them move down.
    fn leave(&mut self) {
        for bit in (0..self.frontier_nodes.len()).rev() {
            if self.wanted[self.frontier_nodes[bit] as usize] == 0 {
                self.leaving.push(bit as u8);
                self.frontier_nodes.remove(bit);
            }
        }
        for (bit, &node) in self.frontier_nodes.iter().enumerate() {
            self.bit_of[node as usize] = bit as u8;
        }
    }
}
