//! What columns of unknown names may be, by how such columns are called, and in which unit their names say.

use crate::formats::table::units::column_and_scale;
use crate::model::dataset::DatasetKind;
use serde_json::{Map, Value};

/// Longer names are no guess.
const MOST_LETTERS: usize = 40;
/// So many columns are proposed.
const MOST: usize = 24;

/// Columns, and what else they are called: letters and digits in lower case.
const SPELLINGS: &[(&str, &[&str])] = &[
    (
        "time_s",
        &[
            "t",
            "time",
            "timestamp",
            "datetime",
            "epoch",
            "unixtime",
            "utc",
            "timeutc",
            "seconds",
            "basedatetime",
        ],
    ),
    ("lat_deg", &["lat", "latitude"]),
    ("lon_deg", &["lon", "long", "lng", "longitude"]),
    (
        "height_m",
        &[
            "h",
            "alt",
            "altitude",
            "height",
            "elev",
            "baroaltitude",
            "geoaltitude",
            "altbaro",
            "altgeom",
            "altitudemsl",
        ],
    ),
    (
        "x_m",
        &["x", "posx", "xpos", "positionx", "east", "easting", "px"],
    ),
    (
        "y_m",
        &["y", "posy", "ypos", "positiony", "north", "northing", "py"],
    ),
    ("z_m", &["z", "posz", "zpos", "positionz", "up", "pz"]),
    (
        "vx_mps",
        &["vx", "velx", "xdot", "velocityx", "veast", "ve"],
    ),
    (
        "vy_mps",
        &["vy", "vely", "ydot", "velocityy", "vnorth", "vn"],
    ),
    ("vz_mps", &["vz", "velz", "zdot", "velocityz", "vup", "vu"]),
    (
        "speed_mps",
        &["speed", "sog", "groundspeed", "gs", "velocity"],
    ),
    (
        "course_deg",
        &["course", "cog", "heading", "hdg", "trackangle"],
    ),
    (
        "range_m",
        &["range", "rng", "r", "rho", "slantrange", "distance"],
    ),
    (
        "bearing_deg",
        &["bearing", "brg", "azimuth", "az", "azi", "theta"],
    ),
    ("elevation_deg", &["elevation", "el", "elevationangle"]),
    (
        "range_rate_mps",
        &[
            "rangerate",
            "rdot",
            "doppler",
            "radialvelocity",
            "radialspeed",
        ],
    ),
    (
        "amplitude",
        &["amp", "snr", "power", "intensity", "strength"],
    ),
    (
        "scan",
        &["scanno", "scannumber", "frame", "frameid", "revolution"],
    ),
    (
        "sensor_id",
        &["sensor", "sensorname", "radar", "station", "site"],
    ),
    (
        "detection_id",
        &["detection", "plot", "plotid", "measurementid"],
    ),
    (
        "track_id",
        &["track", "trackid", "trackno", "tracknumber", "tid"],
    ),
    (
        "truth_id",
        &[
            "truth", "target", "targetid", "objectid", "object", "mmsi", "icao24", "icao", "hex",
            "vessel", "aircraft", "platform", "gtid",
        ],
    ),
];

/// Units as names of columns have them, and as a mapping says them.
const UNITS: &[(&str, &str)] = &[
    ("m", "m"),
    ("meter", "m"),
    ("meters", "m"),
    ("metres", "m"),
    ("km", "km"),
    ("ft", "ft"),
    ("feet", "ft"),
    ("nm", "NM"),
    ("nmi", "NM"),
    ("fl", "FL"),
    ("yd", "yd"),
    ("mps", "mps"),
    ("m/s", "mps"),
    ("kt", "kt"),
    ("kts", "kt"),
    ("kn", "kt"),
    ("knots", "kt"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("km/h", "km/h"),
    ("mph", "mph"),
    ("fpm", "ft/min"),
    ("deg", "deg"),
    ("degrees", "deg"),
    ("rad", "rad"),
    ("s", "s"),
    ("sec", "s"),
    ("ms", "ms"),
    ("us", "us"),
    ("ns", "ns"),
];

/// A mapping of the columns that have no canonical name yet, as JSON; `None` where there is nothing to propose. `names` are the
/// canonical ones of `file_names`, as far as they are known.
pub(super) fn mapping(
    file_names: &[String],
    names: &[String],
    kind: Option<DatasetKind>,
    is_canonical: impl Fn(&str) -> bool,
) -> Option<String> {
    let mut proposed = Map::new();
    let mut taken: Vec<String> = names.to_vec();
    for (file_name, _) in file_names
        .iter()
        .zip(names)
        .filter(|(_, name)| !is_canonical(name))
    {
        let Some((column, said)) = guess(file_name, kind) else {
            continue;
        };
        if said != *file_name && !taken.contains(&column) && proposed.len() < MOST {
            taken.push(column);
            proposed.insert(file_name.clone(), Value::String(said));
        }
    }
    (!proposed.is_empty()).then(|| Value::Object(proposed).to_string())
}

/// The canonical column, and what a mapping says of it.
fn guess(name: &str, kind: Option<DatasetKind>) -> Option<(String, String)> {
    if name.len() > MOST_LETTERS {
        return None;
    }
    let (word, unit) = word_and_unit(&name.trim().to_lowercase());
    let column = match (word.as_str(), kind) {
        ("id" | "identity" | "name", Some(DatasetKind::Tracks)) => "track_id",
        ("id", Some(DatasetKind::Detections)) => "detection_id",
        ("id" | "identity" | "name", _) => "truth_id",
        _ => {
            let found = SPELLINGS.iter().find(|(column, spellings)| {
                spellings.contains(&word.as_str()) || letters(column) == word
            });
            found?.0
        }
    };
    let Some(unit) = unit else {
        return Some((column.to_owned(), column.to_owned()));
    };
    let said = format!("{column} [{unit}]");
    let (_, scale) = column_and_scale(&said).ok()?;
    let said = if scale == 1.0 {
        column.to_owned()
    } else {
        said
    };
    Some((column.to_owned(), said))
}

/// A name without its unit, and the unit: of `alt_ft`, `Range [km]`, `speed(kts)`.
fn word_and_unit(name: &str) -> (String, Option<&'static str>) {
    let unit_named = |text: &str| UNITS.iter().find(|(unit, _)| *unit == text);
    let bracketed = name
        .strip_suffix([']', ')'])
        .and_then(|name| name.rsplit_once(['[', '(']));
    let parted = bracketed.or_else(|| name.rsplit_once(['_', ' ', '-', '.']));
    if let Some((word, unit)) = parted
        && let Some((_, unit)) = unit_named(unit.trim())
    {
        return (letters(word), Some(unit));
    }
    (letters(name), None)
}

fn letters(name: &str) -> String {
    name.chars()
        .filter(|letter| letter.is_alphanumeric())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(name: &str, kind: Option<DatasetKind>) -> Option<String> {
        guess(name, kind).map(|(_, said)| said)
    }

    #[test]
    fn columns_of_others_are_told_with_their_units() {
        let cases = [
            ("Latitude", Some("lat_deg")),
            ("alt_ft", Some("height_m [ft]")),
            ("Altitude (feet)", Some("height_m [ft]")),
            ("Range [NM]", Some("range_m [NM]")),
            ("speed(kts)", Some("speed_mps [kt]")),
            ("Speed [km/h]", Some("speed_mps [km/h]")),
            ("x_m", Some("x_m")),
            ("X [m]", Some("x_m")),
            ("time_ms", Some("time_s [ms]")),
            ("azimuth_rad", Some("bearing_deg [rad]")),
            ("colour", None),
            ("speed_ft", None),
        ];
        for (name, expected) in cases {
            assert_eq!(told(name, None).as_deref(), expected, "{name}");
        }
        assert_eq!(
            told("ID", Some(DatasetKind::Tracks)).as_deref(),
            Some("track_id")
        );
        assert_eq!(told("id", None).as_deref(), Some("truth_id"));
    }

    #[test]
    fn a_column_is_proposed_once_and_never_beside_its_own() {
        let names = |list: &[&str]| {
            list.iter()
                .map(|name| (*name).to_owned())
                .collect::<Vec<_>>()
        };
        let file = names(&["time_s", "Lat", "latitude", "lon_deg", "Longitude"]);
        let known = |name: &str| ["time_s", "lon_deg"].contains(&name);
        let found = mapping(&file, &file, None, known);
        assert_eq!(found.as_deref(), Some(r#"{"Lat":"lat_deg"}"#));
        let none = names(&["time_s"]);
        assert_eq!(mapping(&none, &none, None, known), None);
    }
}
