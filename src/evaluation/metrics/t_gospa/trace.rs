//! How labels came about: what each assigned and switched step by step. Labels that come from one another share what they
//! have in common, so remembering costs no more than what is new at a step.

use super::problem::Solution;

/// Nothing yet.
pub const NO_TRACE: usize = usize::MAX;

#[derive(Debug, Default)]
pub struct Traces(Vec<Node>);

#[derive(Debug)]
struct Node {
    before: [usize; 2],
    /// A pair of the step.
    at: u32,
    assigned: Vec<u32>,
    switches: f64,
}

impl Traces {
    /// The trace that adds what a step assigned (pairs of the comparison) and switched; `at` is a pair of that step.
    pub fn go_on(&mut self, before: usize, at: u32, assigned: Vec<u32>, switches: f64) -> usize {
        if assigned.is_empty() && switches == 0.0 {
            return before;
        }
        self.0.push(Node {
            before: [before, NO_TRACE],
            at,
            assigned,
            switches,
        });
        self.0.len() - 1
    }

    /// The trace of two groups that became one.
    pub fn join(&mut self, one: usize, other: usize) -> usize {
        if one == NO_TRACE || other == NO_TRACE {
            return one.min(other);
        }
        self.0.push(Node {
            before: [one, other],
            at: 0,
            assigned: Vec::new(),
            switches: 0.0,
        });
        self.0.len() - 1
    }

    /// Adds all that a trace holds to the parts of a solution.
    pub fn tell(&self, trace: usize, solution: &mut Solution) {
        let mut open = vec![trace];
        while let Some(trace) = open.pop() {
            let Some(node) = self.0.get(trace) else {
                continue;
            };
            solution
                .shares
                .extend(node.assigned.iter().map(|&pair| (pair, 1.0)));
            solution
                .switches
                .extend((node.switches != 0.0).then_some((node.at, node.switches)));
            open.extend(node.before);
        }
    }
}
