//! What a request may say of the fuzzy c-means grouper.

use crate::correlation::grouping::{FUZZIFIER, MAX_ITERATIONS, ONE_PER_SENSOR, TOLERANCE};
use crate::registry::{Bound, Field, Kind, Object, Union, Variant, default, optional, required};
use serde::Deserialize;

pub(super) static PARAMETERS: Object = Object {
    name: "FuzzyCMeansGrouper",
    summary: "Each report goes to the cluster to which it belongs most.",
    fields: &[
        default(
            "initial",
            "Where the first centres come from.",
            Kind::Union(&INITIAL),
            r#"{"from":"predictions"}"#,
        ),
        FUZZIFIER,
        TOLERANCE,
        MAX_ITERATIONS,
        ONE_PER_SENSOR,
        default(
            "trace",
            "Whether to keep costs, centres and memberships of every iteration for a file.",
            Kind::Flag,
            "false",
        ),
    ],
};

static INITIAL: Union = Union {
    name: "FuzzyInitialCentres",
    summary: "Where the first centres come from.",
    tag: "from",
    variants: || {
        vec![
            Variant {
                tag: "predictions",
                object: &PREDICTIONS,
            },
            Variant {
                tag: "sensor",
                object: &SENSOR,
            },
            Variant {
                tag: "random",
                object: &RANDOM,
            },
            Variant {
                tag: "memberships",
                object: &MEMBERSHIPS,
            },
            Variant {
                tag: "genetic",
                object: &GENETIC,
            },
        ]
    },
};

static PREDICTIONS: Object = Object {
    name: "CentresOfPredictions",
    summary: "One centre where each track is predicted.",
    fields: &[],
};

static SENSOR: Object = Object {
    name: "CentresOfOneSensor",
    summary: "The reports of the sensor that has most, then each time the report that is farthest from all centres.",
    fields: &[CLUSTERS],
};

static RANDOM: Object = Object {
    name: "CentresAtRandom",
    summary: "Different reports, drawn at random.",
    fields: &[CLUSTERS],
};

static MEMBERSHIPS: Object = Object {
    name: "CentresOfRandomMemberships",
    summary: "First memberships drawn at random, c uniform numbers over their sum for each report, and the centres that fit them.",
    fields: &[CLUSTERS],
};

static GENETIC: Object = Object {
    name: "CentresOfGeneticSearch",
    summary: "The best of a population of centres, each driven to its optimum before it is crossed and mutated. The cost is (generations + 1) · population runs.",
    fields: &[
        CLUSTERS,
        default(
            "population",
            "Individuals.",
            Kind::Integer {
                min: 2,
                max: 1000,
                unit: "",
            },
            "10",
        ),
        default(
            "generations",
            "Generations after the first population.",
            Kind::Integer {
                min: 0,
                max: 1000,
                unit: "",
            },
            "10",
        ),
        default(
            "crossover_rate",
            "Probability that a child has two parents.",
            SHARE,
            "0.8",
        ),
        default(
            "mutation_rate",
            "Probability that a centre of a child becomes a random report.",
            SHARE,
            "0.15",
        ),
        optional(
            "driven",
            "Whether fuzzy c-means drives each individual to its optimum; so it is when absent. Without, this is a plain genetic algorithm over centres.",
            Kind::Flag,
        ),
    ],
};

const SHARE: Kind = Kind::Number {
    min: Bound::Including(0.0),
    max: Bound::Including(1.0),
    unit: "",
};

const CLUSTERS: Field = required(
    "clusters",
    "c, the number of clusters.",
    Kind::Union(&CLUSTER_COUNT),
);

static CLUSTER_COUNT: Union = Union {
    name: "ClusterCount",
    summary: "How the number of clusters is known.",
    tag: "by",
    variants: || {
        vec![
            Variant {
                tag: "count",
                object: &COUNT,
            },
            Variant {
                tag: "validity",
                object: &VALIDITY,
            },
        ]
    },
};

static COUNT: Object = Object {
    name: "GivenClusterCount",
    summary: "It is given.",
    fields: &[required("count", "c.", NUMBER)],
};

static VALIDITY: Object = Object {
    name: "ValidClusterCount",
    summary: "Fuzzy c-means runs for each number of a range; the one with the best validity index stays.",
    fields: &[
        default(
            "index",
            "xie_beni: compact clusters far apart; partition_coefficient: memberships near 0 or 1.",
            Kind::Choice(&["xie_beni", "partition_coefficient"]),
            "\"xie_beni\"",
        ),
        default("min", "Smallest c.", NUMBER, "2"),
        required("max", "Largest c.", NUMBER),
    ],
};

const NUMBER: Kind = Kind::Integer {
    min: 2,
    max: 10_000,
    unit: "",
};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub(super) struct Parameters {
    pub initial: Initial,
    pub fuzzifier: f64,
    pub tolerance: f64,
    pub max_iterations: u32,
    pub one_per_sensor: bool,
    pub trace: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "from", rename_all = "snake_case")]
pub(super) enum Initial {
    Predictions,
    Sensor {
        clusters: Clusters,
    },
    Random {
        clusters: Clusters,
    },
    Memberships {
        clusters: Clusters,
    },
    Genetic {
        clusters: Clusters,
        population: u32,
        generations: u32,
        crossover_rate: f64,
        mutation_rate: f64,
        #[serde(default = "yes")]
        driven: bool,
    },
}

fn yes() -> bool {
    true
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
pub(super) enum Clusters {
    Count {
        count: usize,
    },
    Validity {
        index: ValidityIndex,
        min: usize,
        max: usize,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ValidityIndex {
    XieBeni,
    PartitionCoefficient,
}
