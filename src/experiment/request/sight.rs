//! What a request says of where a sensor sees.

use super::fields::{BEARING, PROBABILITY, RANGE};
use crate::registry::{
    Bound, Field, Kind, Object, Union, above, default, list, number, optional, variant, whole,
};

const BEARING_FROM: Field = optional(
    "bearing_from_deg",
    "First bearing, clockwise from north; the whole turn when both are absent.",
    BEARING,
);
const BEARING_TO: Field = optional(
    "bearing_to_deg",
    "Last bearing, clockwise from the first: 300 to 60 holds north.",
    BEARING,
);
const RANGE_FROM: Field = optional(
    "range_from_m",
    "Least range; 0 when absent.",
    number(0.0, 1e9, "m"),
);
const RANGE_TO: Field = optional("range_to_m", "Greatest range; no limit when absent.", RANGE);

static VIEW: Object = Object {
    name: "SensorFieldOfView",
    summary: "Where a sensor sees at all, around the place where it is at the scan: elsewhere P_D is 0, and a miss there says nothing of a track.",
    fields: &[BEARING_FROM, BEARING_TO, RANGE_FROM, RANGE_TO],
};

static SECTOR: Object = Object {
    name: "SensorSector",
    summary: "A part of what a sensor sees with a P_D or clutter of its own; what is absent is the sensor's.",
    fields: &[
        BEARING_FROM,
        BEARING_TO,
        RANGE_FROM,
        RANGE_TO,
        optional(
            "p_d",
            "Probability that a target there is detected; 0 where nothing is seen.",
            number(0.0, 1.0, ""),
        ),
        optional(
            "clutter_per_m2",
            "Expected false detections per square metre and scan there.",
            above(0.0, 1e6, "1/m²"),
        ),
        optional(
            "clutter_per_deg",
            "Expected false detections per degree and scan there, of a sensor whose bearings alone are used.",
            above(0.0, 1e6, "1/deg"),
        ),
    ],
};

static ONE_SECTOR: Kind = Kind::Object(&SECTOR);

pub(super) const FIELD_OF_VIEW: Field = optional(
    "field_of_view",
    "Where the sensor sees at all; everywhere when absent.",
    Kind::Object(&VIEW),
);
pub(super) const SECTORS: Field = optional(
    "sectors",
    "Parts of the field of view that differ from the rest; the first that holds a place says what is seen there.",
    list(&ONE_SECTOR, 1, 64),
);
pub(super) const P_D_AT: Field = optional(
    "p_d_at_m",
    "Range at which p_d holds. With it the probability falls with the range as a radar's does whose targets fluctuate slowly (Swerling 1, an echo that falls with the fourth power).",
    RANGE,
);
pub(super) const P_FA: Field = optional(
    "p_fa",
    "With p_d_at_m: probability of a false alarm in a resolution cell, below p_d; 1e-6 when absent.",
    PROBABILITY,
);

static ESTIMATED: Object = Object {
    name: "EstimatedClutter",
    summary: "One density, of the detections that the tracks of a first pass leave over.",
    fields: &[],
};

static MAP: Object = Object {
    name: "ClutterMap",
    summary: "A map of densities that is learnt scan by scan from what confirmed tracks leave over: of cells in range and bearing around the sensor, in x and y for a sensor of positions, in bearing for one of bearings.",
    fields: &[
        default(
            "alpha",
            "How much of a cell's density a scan replaces: half of a change is followed after ln 0.5 / ln(1 - alpha) scans.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Excluding(1.0),
                unit: "",
            },
            "0.05",
        ),
        default(
            "cells",
            "Cells along each coordinate.",
            whole(1, 100, ""),
            "12",
        ),
    ],
};

static NEAREST: Object = Object {
    name: "NearestClutter",
    summary: "The density at each detection by its k-th nearest neighbour in the scan, for sensors with few detections.",
    fields: &[default("k", "Which neighbour.", whole(2, 50, ""), "5")],
};

static CLUTTER_UNION: Union = Union {
    name: "SensorClutter",
    summary: "How the density of clutter is known.",
    tag: "method",
    variants: || {
        vec![
            variant("estimated", &ESTIMATED),
            variant("map", &MAP),
            variant("nearest", &NEAREST),
        ]
    },
};

pub(super) const CLUTTER: Field = optional(
    "clutter",
    "How the density of clutter is known, if not as the one number that is given; a map begins with that number.",
    Kind::Union(&CLUTTER_UNION),
);
