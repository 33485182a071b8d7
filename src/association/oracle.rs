//! The oracle: told where every detection came from, it gives each track the detection of the target that started it.
//! It costs the filter alone, so it is the yardstick of speed, and of what perfect association would achieve.
//!
//! # Method
//! 1. A track's only candidate is the detection with the origin of the track's first one ([`Needs::Origins`]);
//!    no gate is applied, and a track started by clutter never gets another.
//! 2. Take it.

use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator, Needs};
use crate::registry::{Method, Object};

pub const METHOD: Method<BuildAssociator> = Method {
    name: "oracle",
    parameters: &PARAMETERS,
    build: |_, _| Ok(Box::new(Oracle)),
};

static PARAMETERS: Object = Object {
    name: "Oracle",
    summary: "Told the true origin of every detection: a yardstick, only for recordings that know origins.",
    fields: &[],
};

#[derive(Debug, Clone)]
pub struct Oracle;

impl Associator for Oracle {
    fn needs(&self) -> Needs {
        Needs::Origins
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        for (row, edges) in problem.rows() {
            if let Some(edge) = edges.edges().next() {
                weights.choose(row, edge);
            }
        }
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }
}
