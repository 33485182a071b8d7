//! Tables as they come, row by row.

use super::{Rows, detections, header};
use crate::formats::live::{Broken, Listener};
use crate::formats::{ReadOptions, Reading, Units, layouts};
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;

/// Reads detections as they come; wrong rows are counted, as are those that were `broken`.
///
/// # Errors
/// Faults of the header and of the options.
pub fn follow(
    rows: &mut dyn Rows,
    options: &ReadOptions,
    broken: &Broken,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let mut reading = Reading::of(&options.options)?;
    if options.columns.is_empty()
        && let Some(layout) = layouts::find(rows.names())
    {
        return layouts::follow(rows, layout, &reading, (broken, listener));
    }
    let options = ReadOptions {
        kind: Some(DatasetKind::Detections),
        ..options.clone()
    };
    let (_, header, warnings) = header::resolve(rows, &options)?;
    for warning in warnings {
        listener.warn(warning);
    }
    reading.max_rejected = Some(1.0);
    detections::follow((rows, &header), &reading, broken, listener)
}
