//! The reports of a recording as a tracker takes them.

use super::slant;
use crate::experiment::input::sensors;
use crate::filtering::AnyFilter;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use std::borrow::Cow;

/// Slant ranges along the ground, and noises of detections counted as those of their sensors, where errors persist.
pub fn as_taken<'r>(
    recording: &'r Recording,
    known: &[SensorSettings],
    filter: &AnyFilter,
    warnings: &mut Vec<String>,
) -> Cow<'r, Recording> {
    let recording = slant::along_ground(recording, known, filter, warnings);
    sensors::with_own_noises(recording, known)
}
