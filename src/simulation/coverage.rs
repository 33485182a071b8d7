//! Which sensors see which targets, besides what their fields of view allow.

use crate::math::rng::{Purpose, Seed};
use crate::model::fault::Fault;
use crate::model::scenario::{self, Scenario};
use rand::RngExt;

/// Drawn for one run of a scenario.
pub(super) struct Coverage {
    /// For each target the only sensor that sees it; `None` where all do. Empty where all see everything.
    only: Vec<Option<usize>>,
}

impl Coverage {
    pub fn new(scenario: &Scenario, seed: Seed) -> Self {
        let Some(scenario::Coverage::Duplicates { count }) = scenario.coverage else {
            return Coverage { only: Vec::new() };
        };
        let targets = scenario.targets.count();
        let mut draw = seed.stream(Purpose::Coverage, 0, 0);
        let mut only: Vec<Option<usize>> = (0..targets)
            .map(|_| Some(draw.random_range(0..scenario.sensors.len())))
            .collect();
        // The first `count` places of a random order (R. A. Fisher, F. Yates).
        let mut order: Vec<usize> = (0..targets).collect();
        for place in 0..(count as usize).min(targets) {
            order.swap(place, draw.random_range(place..targets));
            only[order[place]] = None;
        }
        Coverage { only }
    }

    pub fn includes(&self, sensor: usize, target: usize) -> bool {
        self.only
            .get(target)
            .copied()
            .flatten()
            .is_none_or(|only| only == sensor)
    }
}

/// There cannot be more targets of a kind than targets.
pub(super) fn fault(scenario: &Scenario) -> Option<Fault> {
    let scenario::Coverage::Duplicates { count } = scenario.coverage?;
    let targets = scenario.targets.count();
    (count as usize > targets).then(|| {
        let detail = format!("{count} of {targets} targets cannot be seen by all sensors");
        Fault::new("/coverage/count", "out_of_range", detail).allowing(format!("[0, {targets}]"))
    })
}
