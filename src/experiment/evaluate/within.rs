//! Where, when and whom a job judges: described field by field, and brought to the plane of the data.

use crate::evaluation::scope::{Area, Scope};
use crate::geodesy::Stereographic;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;
use crate::model::state::Position;
use crate::model::truth::TruthSet;
use crate::registry::{
    Field, Kind, Object, Union, default, list, number, optional, required, variant,
};
use serde::Deserialize;

pub const PLACE_M: Kind = number(-1e8, 1e8, "m");

static CORNER: Object = Object {
    name: "Corner",
    summary: "A corner of a polygon, x east and y north.",
    fields: &[
        required("x_m", "East.", PLACE_M),
        required("y_m", "North.", PLACE_M),
    ],
};

static CORNER_DEG: Object = Object {
    name: "CornerDeg",
    summary: "A corner of a polygon on the Earth.",
    fields: &[
        required("lat_deg", "Latitude.", number(-90.0, 90.0, "deg")),
        required("lon_deg", "Longitude.", number(-180.0, 360.0, "deg")),
    ],
};

const MOST_CORNERS: usize = 10_000;

static POLYGON: Object = Object {
    name: "PolygonArea",
    summary: "A polygon in the plane of the data; its edge belongs to it.",
    fields: &[required(
        "corners",
        "In order.",
        list(&Kind::Object(&CORNER), 3, MOST_CORNERS),
    )],
};

static POLYGON_DEG: Object = Object {
    name: "PolygonDegArea",
    summary: "A polygon of latitudes and longitudes, for data whose plane has an origin; edges are straight in that plane.",
    fields: &[required(
        "corners",
        "In order.",
        list(&Kind::Object(&CORNER_DEG), 3, MOST_CORNERS),
    )],
};

static SECTOR: Object = Object {
    name: "SectorArea",
    summary: "Ranges and bearings about a place: a circle, a ring, or a part of one.",
    fields: &[
        default("x_m", "Its centre, east.", PLACE_M, "0.0"),
        default("y_m", "Its centre, north.", PLACE_M, "0.0"),
        default(
            "range_min_m",
            "Nearest range.",
            number(0.0, 1e8, "m"),
            "0.0",
        ),
        required("range_max_m", "Farthest range.", number(0.0, 1e8, "m")),
        optional(
            "from_deg",
            "First bearing, clockwise from north; all around when absent.",
            number(-360.0, 360.0, "deg"),
        ),
        optional("to_deg", "Last bearing.", number(-360.0, 360.0, "deg")),
    ],
};

static COVERAGE: Object = Object {
    name: "CoverageArea",
    summary: "Where a sensor of the recording sees: its 'field_of_view', else its 'max_range_m', around where it stands.",
    fields: &[required(
        "sensor_id",
        "The sensor.",
        Kind::Text { max_length: 200 },
    )],
};

/// A place in the plane or on the Earth.
pub static AREA: Union = Union {
    name: "Area",
    summary: "Where targets are due.",
    tag: "kind",
    variants: || {
        vec![
            variant("polygon", &POLYGON),
            variant("polygon_deg", &POLYGON_DEG),
            variant("sector", &SECTOR),
            variant("coverage", &COVERAGE),
        ]
    },
};

static WITHIN: Object = Object {
    name: "Within",
    summary: "What is judged of truth and tracks. What lies outside is left out and counted.",
    fields: &[
        optional("from_s", "First time.", number(-1e15, 1e15, "s")),
        optional("to_s", "Last time.", number(-1e15, 1e15, "s")),
        optional(
            "targets",
            "Names of the targets that are due; tracks on others are left out.",
            list(&Kind::Text { max_length: 200 }, 1, 100_000),
        ),
        optional(
            "areas",
            "Targets are due in any of these; everywhere when absent.",
            list(&Kind::Union(&AREA), 1, 100),
        ),
        optional("height_min_m", "Lowest height, of a volume.", PLACE_M),
        optional("height_max_m", "Highest height, of a volume.", PLACE_M),
    ],
};

/// The field of `comparison`.
pub const FIELD: Field = optional(
    "within",
    "Where, when and whom to judge. Tracks near a target that is not due are left out, others outside too; a false track inside counts.",
    Kind::Object(&WITHIN),
);

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Corner {
    x_m: f64,
    y_m: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct CornerDeg {
    lat_deg: f64,
    lon_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum AreaSpec {
    Polygon {
        corners: Vec<Corner>,
    },
    PolygonDeg {
        corners: Vec<CornerDeg>,
    },
    Sector {
        x_m: f64,
        y_m: f64,
        range_min_m: f64,
        range_max_m: f64,
        from_deg: Option<f64>,
        to_deg: Option<f64>,
    },
    Coverage {
        sensor_id: String,
    },
}

/// A recording, and what is known of each of its sensors.
pub type Seen<'d> = (&'d Recording, &'d [SensorSettings]);

/// As the request has it.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct WithinSpec {
    from_s: Option<f64>,
    to_s: Option<f64>,
    targets: Option<Vec<String>>,
    #[serde(default)]
    areas: Vec<AreaSpec>,
    height_min_m: Option<f64>,
    height_max_m: Option<f64>,
}

impl WithinSpec {
    /// What no table can see.
    pub fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (name, low, high) in [
            ("to_s", self.from_s, self.to_s),
            ("height_max_m", self.height_min_m, self.height_max_m),
        ] {
            if low.zip(high).is_some_and(|(low, high)| high < low) {
                let detail = "it ends before it begins";
                faults.push(Fault::new(
                    format!("/comparison/within/{name}"),
                    "out_of_range",
                    detail,
                ));
            }
        }
        faults.extend(AreaSpec::faults(&self.areas, "/comparison/within/areas"));
        faults
    }

    /// In the plane of the truth, with the sensors of the recording.
    ///
    /// # Errors
    /// Latitudes where the plane has no origin, names that no target has, and sensors without a coverage.
    pub fn scope(&self, truth: &TruthSet, recording: Option<Seen>) -> Result<Scope, Vec<Fault>> {
        let mut faults = self.unknown_targets(truth);
        faults.extend(self.heights_of_nothing(truth));
        let areas = AreaSpec::in_plane(
            &self.areas,
            (truth, recording),
            "/comparison/within/areas",
            &mut faults,
        );
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Scope {
            from_s: self.from_s,
            to_s: self.to_s,
            targets: self
                .targets
                .as_ref()
                .map(|names| names.iter().cloned().collect()),
            areas,
            height_m: (self.height_min_m, self.height_max_m),
        })
    }

    /// In the plane nothing would be left out, as nothing has a height there.
    fn heights_of_nothing(&self, truth: &TruthSet) -> Vec<Fault> {
        if truth.space() == Space::Volume {
            return Vec::new();
        }
        let mut faults = Vec::new();
        for (name, height_m) in [
            ("height_min_m", self.height_min_m),
            ("height_max_m", self.height_max_m),
        ] {
            if height_m.is_some() {
                let detail = "the truth has no z_m, so that no point has a height to be judged by";
                let fault = Fault::new(format!("/comparison/within/{name}"), "unsupported", detail);
                faults.push(
                    fault.allowing("a truth with z_m; sectors of requirements read height_m"),
                );
            }
        }
        faults
    }

    fn unknown_targets(&self, truth: &TruthSet) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (index, name) in self.targets.iter().flatten().enumerate() {
            if !truth
                .targets()
                .iter()
                .any(|target| target.truth_id == *name)
            {
                let pointer = format!("/comparison/within/targets/{index}");
                let detail = format!("the truth has no target '{name}'");
                faults.push(Fault::new(pointer, "unknown_value", detail));
            }
        }
        faults
    }
}

impl AreaSpec {
    /// What no table can see of areas that stand at a pointer.
    pub fn faults(areas: &[AreaSpec], place: &str) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (index, area) in areas.iter().enumerate() {
            let pointer = format!("{place}/{index}");
            let AreaSpec::Sector {
                range_min_m,
                range_max_m,
                from_deg,
                to_deg,
                ..
            } = area
            else {
                continue;
            };
            if range_max_m <= range_min_m {
                let detail = "it ends before it begins";
                faults.push(Fault::new(
                    format!("{pointer}/range_max_m"),
                    "out_of_range",
                    detail,
                ));
            }
            if from_deg.is_some() != to_deg.is_some() {
                let detail = "a part of the circle has 'from_deg' and 'to_deg'";
                faults.push(Fault::new(pointer, "missing", detail).allowing("both, or none"));
            }
        }
        faults
    }

    /// Areas in the plane of the truth; a fault for each that has none there.
    pub fn in_plane(
        areas: &[AreaSpec],
        data: (&TruthSet, Option<Seen>),
        place: &str,
        faults: &mut Vec<Fault>,
    ) -> Vec<Area> {
        let mut found = Vec::new();
        for (index, area) in areas.iter().enumerate() {
            match area.in_plane_of(data) {
                Ok(area) => found.push(area),
                Err(mut fault) => {
                    fault.pointer = format!("{place}/{index}{}", fault.pointer);
                    faults.push(fault);
                }
            }
        }
        found
    }

    fn in_plane_of(&self, (truth, recording): (&TruthSet, Option<Seen>)) -> Result<Area, Fault> {
        Ok(match self {
            AreaSpec::Polygon { corners } => Area::Polygon(
                corners
                    .iter()
                    .map(|corner| Position::new(corner.x_m, corner.y_m))
                    .collect(),
            ),
            AreaSpec::PolygonDeg { corners } => {
                let frame = truth.frame.as_ref().ok_or_else(without_latitudes)?;
                let plane = Stereographic::about(frame.latitude_deg(), frame.longitude_deg());
                let project = |corner: &CornerDeg| plane.project(corner.lat_deg, corner.lon_deg);
                Area::Polygon(corners.iter().map(project).collect())
            }
            AreaSpec::Sector {
                x_m,
                y_m,
                range_min_m,
                range_max_m,
                from_deg,
                to_deg,
            } => Area::Sector {
                centre: Position::new(*x_m, *y_m),
                range_m: (*range_min_m, *range_max_m),
                bearings_rad: from_deg
                    .zip(*to_deg)
                    .map(|(from, to)| (from.to_radians(), to.to_radians())),
            },
            AreaSpec::Coverage { sensor_id } => coverage(sensor_id, recording)?,
        })
    }
}

fn without_latitudes() -> Fault {
    let detail = "the truth has no latitudes and longitudes, so nobody knows where these corners are in its plane";
    Fault::new("", "unsupported", detail).allowing("polygon, sector")
}

fn coverage(sensor_id: &str, recording: Option<Seen>) -> Result<Area, Fault> {
    let Some((recording, sensors)) = recording else {
        let detail = "without a recording there are no sensors";
        return Err(Fault::new("", "missing", detail).allowing("polygon, sector, or detections"));
    };
    let Some(index) = sensors
        .iter()
        .position(|sensor| sensor.sensor_id == sensor_id)
    else {
        let names: Vec<&str> = sensors
            .iter()
            .map(|sensor| sensor.sensor_id.as_str())
            .collect();
        let detail = format!("the recording has no sensor '{sensor_id}'");
        let fault = Fault::new("/sensor_id", "unknown_value", detail);
        return Err(fault.allowing(names.join(", ")));
    };
    let mut scans = recording.scans.iter().filter(|scan| scan.sensor == index);
    if scans.any(|scan| scan.pose.is_some()) {
        let detail = format!("the sensor '{sensor_id}' moves, and what it covers with it");
        return Err(
            Fault::new("/sensor_id", "unsupported", detail).allowing("a sensor that stands")
        );
    }
    let sensor = &sensors[index];
    let Some(limits) = sensor.limits() else {
        let detail = format!("the sensor '{sensor_id}' does not say where it sees");
        let fault = Fault::new("/sensor_id", "unsupported", detail);
        return Err(fault.allowing("a sensor with 'field_of_view' or 'max_range_m'"));
    };
    let [x_m, y_m] = [sensor.x_m, sensor.y_m].map(Option::unwrap_or_default);
    Ok(Area::Coverage {
        from: Position::new(x_m, y_m),
        limits,
    })
}
