//! Data for tests of pictures.

use super::Window;
use crate::formats::{ReadOptions, format_named};
use crate::model::dataset::Dataset;

/// The dataset of a table.
pub(super) fn read(text: &str) -> Dataset {
    let csv = format_named("csv").unwrap();
    (csv.read)(&mut text.as_bytes(), &ReadOptions::default())
        .unwrap()
        .dataset
}

/// Everything, of few points.
pub(super) fn everything() -> Window {
    Window {
        max_points: 100,
        ..Window::default()
    }
}
