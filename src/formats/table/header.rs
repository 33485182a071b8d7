//! Column names: which the kinds of dataset know, what the uploader renamed, what is missing or twice there.

mod guess;
mod schemas;
mod told;

use super::detections::{OWN_COLUMNS, POSE_COLUMNS};
use super::{FaultLog, Rows, units};
use crate::formats::ReadOptions;
use crate::model::attributes::{ATTRIBUTES, attribute_named};
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
pub use schemas::{
    BEARING_COVARIANCE, COVARIANCE, MODE_COLUMNS, TIME_BASE, VELOCITY, VOLUME_COVARIANCE,
    VOLUME_VELOCITY,
};
use schemas::{
    BEARING_TRACKS, DETECTIONS, EVERYWHERE, PLANAR_PARTS, Schema, TRACKS, TRACKS_IN_VOLUME,
    TRUE_BEARINGS, TRUTH, TRUTH_IN_VOLUME,
};
use told::{check_duplicates, listed, warnings};

impl Schema {
    /// Truth and tracks are of places unless all that the columns have is a direction; of a volume where places have a z.
    /// `None` of what is no table.
    fn of(kind: DatasetKind, names: &[String]) -> Option<&'static Schema> {
        let has = |name: &str| names.iter().any(|known| known == name);
        let schema = match (kind, has("bearing_deg") && !has("x_m") && !has("y_m")) {
            (DatasetKind::BearingTime, _) => return None,
            (DatasetKind::Detections, _) => &DETECTIONS,
            (DatasetKind::Truth, false) if has("z_m") => &TRUTH_IN_VOLUME,
            (DatasetKind::Truth, false) => &TRUTH,
            (DatasetKind::Truth, true) => &TRUE_BEARINGS,
            (DatasetKind::Tracks, false) if has("z_m") => &TRACKS_IN_VOLUME,
            (DatasetKind::Tracks, false) => &TRACKS,
            (DatasetKind::Tracks, true) => &BEARING_TRACKS,
        };
        Some(schema)
    }

    fn is_used(&self, name: &str) -> bool {
        self.required.contains(&name)
            || self.optional.contains(&name)
            || EVERYWHERE.contains(&name)
            || self.of_rows().iter().any(|names| names.contains(&name))
            || attribute_named(name).is_some()
    }

    /// How well a detection was measured, and where its sensor was.
    fn of_rows(&self) -> &'static [&'static [&'static str]] {
        let known: &[&[&str]] = &[&OWN_COLUMNS, &POSE_COLUMNS];
        if std::ptr::eq(self, &DETECTIONS) {
            known
        } else {
            &[]
        }
    }

    fn is_unused(&self, name: &str) -> bool {
        self.unused.contains(&name)
    }

    /// Columns of the plane in a file of a volume: they say nothing of its third axis, so they are not read.
    fn planar_parts(&self, names: &[String]) -> impl Iterator<Item = &'static [&'static str]> {
        let parts = PLANAR_PARTS.iter().filter(|(whole, part)| {
            let is_there = |name: &&&str| has(names, name);
            self.together.contains(whole)
                && part.iter().all(|name| has(names, name))
                && whole.iter().filter(is_there).count() == part.len()
        });
        parts.map(|(_, part)| *part)
    }

    fn known(&self) -> String {
        [
            self.required,
            self.optional,
            &self.of_rows().concat(),
            self.unused,
            EVERYWHERE,
            ATTRIBUTES,
        ]
        .concat()
        .join(", ")
    }
}

/// The canonical names of a table's columns.
pub struct Header {
    names: Vec<String>,
    /// What a number of each column is multiplied with.
    scales: Vec<f64>,
}

impl Header {
    pub fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    /// What a number of a column is multiplied with.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// The columns of attributes.
    pub fn attributes(&self) -> Vec<(&'static str, usize)> {
        let columns = self.names.iter().enumerate();
        let attributes = columns.filter_map(|(index, name)| Some((attribute_named(name)?, index)));
        attributes.collect()
    }

    /// Whether places are latitudes and longitudes alone.
    pub fn is_geographic(&self) -> bool {
        is_geographic(&self.names)
    }

    /// Longitude and latitude beside places in the plane.
    pub fn beside_plane(&self) -> Option<[usize; 2]> {
        let earth = self.find("lon_deg").zip(self.find("lat_deg"));
        let is_plane = self.find("x_m").is_some() && self.find("z_m").is_none();
        earth.filter(|_| is_plane).map(|(lon, lat)| [lon, lat])
    }

    /// The places of all these columns, if none is missing.
    pub fn all(&self, names: &[&str]) -> Option<Vec<usize>> {
        names.iter().map(|name| self.find(name)).collect()
    }

    /// A column that [`resolve`] made sure of.
    pub fn required(&self, name: &str) -> usize {
        self.find(name)
            .expect("resolve refuses a header without its required columns")
    }
}

/// Applies the uploader's renaming, tells the kind where it was not given, and checks the names.
///
/// # Errors
/// Every fault of the header and of the renaming.
pub fn resolve(
    rows: &dyn Rows,
    options: &ReadOptions,
) -> Result<(DatasetKind, Header, Vec<String>), Vec<Fault>> {
    let mut faults = FaultLog::default();
    let (mut names, mut scales) = (Vec::new(), Vec::new());
    for name in rows.names() {
        let (canonical, scale) = mapped(name, options, &mut faults);
        names.push(canonical);
        scales.push(scale);
    }
    check_renaming_source(rows, options, &mut faults);
    let Some(kind) = options.kind.or_else(|| kind_of(&names)) else {
        let detail = "the columns do not say what the file holds: tracks have 'track_id', truth 'truth_id', detections 'scan' or 'detection_id', or `kind` says that they are detections";
        let cure = cure_after(rows, &names, None);
        faults.push(
            rows.header_fault(None, "missing", format!("{detail}{cure}"))
                .allowing("tracks, detections, truth"),
        );
        return Err(faults.finish().err().unwrap_or_default());
    };
    let schema = Schema::of(kind, &names).ok_or_else(|| vec![super::no_table()])?;
    check_renaming_target(schema, kind, options, &mut faults);
    check_duplicates(rows, &names, &mut faults);
    check_missing(rows, schema, kind, &names, &mut faults);
    faults.finish()?;
    let mut warnings = warnings(schema, rows.names(), &names);
    warnings.extend(cure(rows, &names, Some(kind)));
    Ok((kind, Header { names, scales }, warnings))
}

/// The canonical name of a column, and what its numbers are multiplied with. A name that differs from a canonical one in case
/// alone is that one.
fn mapped(name: &str, options: &ReadOptions, faults: &mut FaultLog) -> (String, f64) {
    let Some(said) = options.columns.get(name) else {
        let mut lower = name.trim().to_ascii_lowercase();
        if lower == "time" {
            "time_s".clone_into(&mut lower);
        }
        let is_known = is_canonical(&lower);
        return (if is_known { lower } else { name.to_owned() }, 1.0);
    };
    match units::column_and_scale(said) {
        Ok((column, scale)) => (column.to_owned(), scale),
        Err(detail) => {
            faults.push(renaming_fault(name, &detail).allowing(units::allowed()));
            (said.clone(), 1.0)
        }
    }
}

fn is_canonical(name: &str) -> bool {
    let schemas = [
        &DETECTIONS,
        &TRUTH,
        &TRUE_BEARINGS,
        &TRUTH_IN_VOLUME,
        &TRACKS,
        &TRACKS_IN_VOLUME,
        &BEARING_TRACKS,
    ];
    schemas
        .iter()
        .any(|schema| schema.is_used(name) || schema.is_unused(name))
}

fn kind_of(names: &[String]) -> Option<DatasetKind> {
    if has(names, "track_id") {
        Some(DatasetKind::Tracks)
    } else if has(names, "detection_id") || has(names, "scan") {
        Some(DatasetKind::Detections)
    } else {
        has(names, "truth_id").then_some(DatasetKind::Truth)
    }
}

fn check_renaming_source(rows: &dyn Rows, options: &ReadOptions, faults: &mut FaultLog) {
    for name in options
        .columns
        .keys()
        .filter(|name| !rows.names().contains(name))
    {
        let detail = format!("the file has no column '{name}'");
        faults.push(
            renaming_fault(name, &detail).allowing(listed(rows.names().iter().map(String::as_str))),
        );
    }
}

fn check_renaming_target(
    schema: &Schema,
    kind: DatasetKind,
    options: &ReadOptions,
    faults: &mut FaultLog,
) {
    for (name, said) in &options.columns {
        let target = units::column_and_scale(said).map_or(said.as_str(), |(column, _)| column);
        if !schema.is_used(target) && !schema.is_unused(target) {
            let detail = format!("'{target}' is not a column of {}", kind.name());
            faults.push(renaming_fault(name, &detail).allowing(schema.known()));
        }
    }
}

fn renaming_fault(name: &str, detail: &str) -> Fault {
    Fault::new(
        format!("/meta/columns/{}", pointer_token(name)),
        "unknown_value",
        detail,
    )
}

/// A name as a token of a JSON pointer.
pub fn pointer_token(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

fn check_missing(
    rows: &dyn Rows,
    schema: &Schema,
    kind: DatasetKind,
    names: &[String],
    faults: &mut FaultLog,
) {
    let cure = cure_after(rows, names, Some(kind));
    let mut missing = |name: &str, detail: String| {
        faults.push(
            rows.header_fault(Some(name), "missing", format!("{detail}{cure}"))
                .allowing(schema.known()),
        );
    };
    let place: &[&str] = if is_geographic(names) {
        &["x_m", "y_m"]
    } else {
        &[]
    };
    for &name in schema.required.iter().filter(|name| !has(names, name)) {
        if place.contains(&name) {
            continue;
        }
        missing(
            name,
            format!("a file of {} needs a column '{name}'", kind.name()),
        );
    }
    let planar: Vec<&str> = schema.planar_parts(names).flatten().copied().collect();
    for group in schema.together.iter().filter(|group| {
        let mut present = group.iter().filter(|name| has(names, name));
        present.any(|name| !planar.contains(name))
    }) {
        for &name in group.iter().filter(|name| !has(names, name)) {
            missing(
                name,
                format!(
                    "column '{name}' is missing: {} come together",
                    group.join(", ")
                ),
            );
        }
    }
    if kind == DatasetKind::Detections && has(names, "range_m") && !has(names, "bearing_deg") {
        missing(
            "bearing_deg",
            "column 'bearing_deg' is missing: range_m, bearing_deg come together".to_owned(),
        );
    } else if kind == DatasetKind::Detections
        && !["x_m", "y_m", "bearing_deg", "lat_deg"]
            .iter()
            .any(|name| has(names, name))
    {
        missing(
            "x_m",
            "detections need measurements: x_m, y_m or lat_deg, lon_deg or range_m, bearing_deg or bearing_deg"
                .to_owned(),
        );
    }
}

/// What may be meant by names that are not known.
fn cure(rows: &dyn Rows, names: &[String], kind: Option<DatasetKind>) -> Option<String> {
    let mapping = guess::mapping(rows.names(), names, kind, is_canonical)?;
    Some(format!("columns may be mapped: {mapping}"))
}

/// The same at the end of a sentence.
fn cure_after(rows: &dyn Rows, names: &[String], kind: Option<DatasetKind>) -> String {
    cure(rows, names, kind).map_or(String::new(), |cure| format!("; {cure}"))
}

/// Whether places are latitudes and longitudes alone.
fn is_geographic(names: &[String]) -> bool {
    has(names, "lat_deg") && has(names, "lon_deg") && !has(names, "x_m")
}

fn has(names: &[String], name: &str) -> bool {
    names.iter().any(|known| known == name)
}
