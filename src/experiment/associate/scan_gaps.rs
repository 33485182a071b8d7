//! What is said of scans that a recording lacks: a tracker takes the scans that are there, so nothing is missed in between.

use crate::model::scan::Recording;
use crate::model::scan_numbers::{self, Gap};

/// Gaps that are named.
const EXAMPLES: usize = 3;

/// A warning where scan numbers jump.
pub fn warning(recording: &Recording) -> Option<String> {
    let gaps = scan_numbers::gaps(recording);
    let missing: u64 = gaps.iter().map(|gap| u64::from(gap.missing)).sum();
    let named: Vec<String> = gaps
        .iter()
        .take(EXAMPLES)
        .map(|gap| describe_gap(recording, gap))
        .collect();
    let others = gaps.len().saturating_sub(EXAMPLES);
    let and_others = if others > 0 {
        format!(", and {others} more such gaps")
    } else {
        String::new()
    };
    (!gaps.is_empty()).then(|| {
        format!(
            "{missing} scan(s) are missing, told from the scan numbers: {}{and_others}; no track counts them as missed. A scan that saw \
             nothing is a row with time_s, scan and sensor_id alone",
            named.join(", ")
        )
    })
}

fn describe_gap(recording: &Recording, gap: &Gap) -> String {
    let (before, after) = (&recording.scans[gap.before], &recording.scans[gap.after]);
    let sensor_id = &recording.sensors[after.sensor].sensor_id;
    let (from, to) = (after.number - gap.missing, after.number - 1);
    let numbers = if from == to {
        format!("scan {from}")
    } else {
        format!("scans {from} to {to}")
    };
    format!(
        "{numbers} of '{sensor_id}' between {} s and {} s",
        before.time_s, after.time_s
    )
}
