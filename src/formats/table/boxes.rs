//! Boxes as rows, for looking at them: one object in one frame a row.

use super::Sink;
use crate::model::boxes::BoxSet;
use std::io;

/// Writes frame after frame; `id` names the column of the objects.
///
/// # Errors
/// What the output says.
pub fn write(set: &BoxSet, id: &'static str, sink: &mut dyn Sink) -> io::Result<()> {
    sink.begin(&[
        "frame",
        id,
        "left_px",
        "top_px",
        "width_px",
        "height_px",
        "confidence",
    ])?;
    for one in set.boxes() {
        sink.number(Some(f64::from(one.frame)))?;
        sink.text(Some(&set.object_ids()[one.object as usize]))?;
        for value in [
            one.left_px,
            one.top_px,
            one.width_px,
            one.height_px,
            one.confidence,
        ] {
            sink.number(Some(value))?;
        }
        sink.end_row()?;
    }
    Ok(())
}
