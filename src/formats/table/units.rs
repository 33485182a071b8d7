//! Units of a file's columns: a mapping names the column, and in brackets its unit, such as `height_m [ft]`.

/// The unit of a canonical column's name, what a file may have in its place, and how many of the first make one of it.
const UNITS: &[(&str, &[(&str, f64)])] = &[
    ("_m", LENGTHS),
    ("_mps", SPEEDS),
    (
        "_deg",
        &[
            ("deg", 1.0),
            ("rad", 180.0 / std::f64::consts::PI),
            ("mil", 360.0 / 6400.0),
        ],
    ),
    (
        "_s",
        &[
            ("s", 1.0),
            ("ms", 1e-3),
            ("us", 1e-6),
            ("ns", 1e-9),
            ("min", 60.0),
            ("h", 3600.0),
        ],
    ),
    ("_ft", &[("ft", 1.0), ("m", 1.0 / 0.3048), ("FL", 100.0)]),
];

const LENGTHS: &[(&str, f64)] = &[
    ("m", 1.0),
    ("km", 1000.0),
    ("ft", 0.3048),
    ("NM", 1852.0),
    ("FL", 30.48),
    ("yd", 0.9144),
    ("mi", 1609.344),
    ("cm", 0.01),
    ("mm", 0.001),
];

const SPEEDS: &[(&str, f64)] = &[
    ("mps", 1.0),
    ("m/s", 1.0),
    ("kt", 1852.0 / 3600.0),
    ("km/h", 1.0 / 3.6),
    ("ft/min", 0.00508),
    ("mph", 0.44704),
];

/// The column of a mapping, and what its numbers are multiplied with.
///
/// # Errors
/// A unit that is not one of the column.
pub fn column_and_scale(said: &str) -> Result<(&str, f64), String> {
    let Some((column, unit)) = said.strip_suffix(']').and_then(|said| said.split_once('[')) else {
        return Ok((said, 1.0));
    };
    let (column, unit) = (column.trim(), unit.trim());
    let of_column = UNITS.iter().find(|(suffix, _)| column.ends_with(suffix));
    let scale = of_column.and_then(|(_, units)| units.iter().find(|(name, _)| *name == unit));
    scale
        .map(|(_, scale)| (column, *scale))
        .ok_or_else(|| format!("'{unit}' is no unit that '{column}' can be in"))
}

/// What a mapping may say.
pub fn allowed() -> String {
    let list = |units: &[(&str, f64)]| {
        units
            .iter()
            .map(|(name, _)| *name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let each: Vec<String> = UNITS
        .iter()
        .map(|(suffix, units)| format!("…{suffix} [{}]", list(units)))
        .collect();
    each.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mapping_names_a_column_and_its_unit() {
        assert_eq!(column_and_scale("height_m [ft]"), Ok(("height_m", 0.3048)));
        assert_eq!(column_and_scale("x_m"), Ok(("x_m", 1.0)));
        assert_eq!(
            column_and_scale("speed_mps[kt]"),
            Ok(("speed_mps", 1852.0 / 3600.0))
        );
        assert_eq!(column_and_scale("time_s [ms]"), Ok(("time_s", 0.001)));
        assert!(column_and_scale("x_m [kt]").is_err());
        assert!(column_and_scale("truth_id [m]").is_err());
    }
}
