//! Whether two jobs judge the same: what they read, and of campaigns what their grids change of it.

use super::Side;
use serde_json::Value;

/// Parts of a request that say what is read; how it is tracked and what is required are not among them.
const PARTS: [&str; 5] = ["input", "detections", "truth", "tracks", "sequences"];

/// Two trackers on one truth are compared: what is judged may differ there.
pub(super) fn reads_other_data(side: &Side, other: &Side) -> bool {
    let (ours, theirs) = (&side.spec, &other.spec);
    match (ours.get("base"), theirs.get("base")) {
        (Some(base), Some(other)) => {
            differ(base, other) || data_changes(ours) != data_changes(theirs)
        }
        (None, None) => differ(ours, theirs),
        _ => true,
    }
}

fn differ(spec: &Value, other: &Value) -> bool {
    let parts = |name: &str| (spec.get(name), other.get(name));
    if let (Some(ours), Some(theirs)) = parts("truth") {
        let (input, other) = parts("input");
        return ours != theirs || (input.is_some() && other.is_some() && input != other);
    }
    PARTS.into_iter().any(|name| {
        let (ours, theirs) = parts(name);
        ours != theirs
    })
}

/// The axes of a grid that change what is read.
fn data_changes(spec: &Value) -> Vec<&Value> {
    let of_data = |change: &&Value| {
        let part = change["path"]
            .as_str()
            .and_then(|path| path.split('/').nth(1));
        part.is_some_and(|part| PARTS.contains(&part))
    };
    let axes = spec["grid"].as_array().into_iter().flatten();
    axes.flat_map(|axis| {
        let variants = axis["variants"].as_array().into_iter().flatten();
        let sets = variants.flat_map(|variant| variant["set"].as_array().into_iter().flatten());
        [axis].into_iter().chain(sets).filter(of_data)
    })
    .collect()
}
