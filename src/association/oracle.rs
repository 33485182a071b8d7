//! The oracle: told where every detection came from, it gives each track the detection of the target that started it.
//! It costs the filter alone, so it is the yardstick of speed, and of what perfect association would achieve.
//!
//! # Method
//! 1. A track's only candidate is the detection with the origin of the track's first one ([`Needs::Origins`]);
//!    no gate is applied, and a track started by clutter never gets another.
//! 2. Take it.
//!
//! With `objectives` the detections of the gate are candidates beside it ([`Needs::OriginsInGates`]): they are never taken, and the
//! objectives of the bat algorithm are compared over all of them.

use super::bat::at_truth::ObjectivesAtTruth;
use super::problem::{Problem, Weights};
use super::{Associator, BuildAssociator, Needs};
use crate::registry::{Kind, Method, Object, default};
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildAssociator> = Method {
    name: "oracle",
    parameters: &PARAMETERS,
    build: |spec, _| {
        let Parameters { objectives } = Parameters::deserialize(spec)?;
        Ok(Box::new(Oracle {
            objectives: objectives.then(ObjectivesAtTruth::default),
        }))
    },
};

static PARAMETERS: Object = Object {
    name: "Oracle",
    summary: "Told the true origin of every detection: a yardstick, only for recordings that know origins.",
    fields: &[default(
        "objectives",
        "Whether to count the clusters in which the objectives of the bat algorithm are largest at the truth (association.diagnostics).",
        Kind::Flag,
        "false",
    )],
};

#[derive(Deserialize, Default)]
#[serde(default)]
struct Parameters {
    objectives: bool,
}

#[derive(Debug, Clone)]
struct Oracle {
    /// Only when they are to be looked at.
    objectives: Option<ObjectivesAtTruth>,
}

impl Associator for Oracle {
    fn needs(&self) -> Needs {
        match self.objectives {
            Some(_) => Needs::OriginsInGates,
            None => Needs::Origins,
        }
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        let Some(objectives) = &mut self.objectives else {
            for (row, edges) in problem.rows() {
                if let Some(edge) = edges.edges().next() {
                    weights.choose(row, edge);
                }
            }
            return;
        };
        objectives.look(problem);
        for (row, edges) in problem.rows() {
            // The own detection is the first of the candidates.
            if problem.own(row).is_some() {
                weights.choose(row, edges.first as usize);
            }
        }
    }

    fn diagnostics(&self) -> Option<serde_json::Value> {
        let objectives = self.objectives.as_ref()?;
        Some(json!({"objectives": objectives.report()}))
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(self.clone())
    }

    fn memory(&self) -> serde_json::Value {
        json!(self.objectives.as_ref().map(ObjectivesAtTruth::counts))
    }

    fn recall(&mut self, memory: &serde_json::Value) -> Result<(), serde_json::Error> {
        if let (Some(objectives), Some(counts)) =
            (&mut self.objectives, Deserialize::deserialize(memory)?)
        {
            objectives.set_counts(counts);
        }
        Ok(())
    }
}
