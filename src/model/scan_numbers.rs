//! Which scans a recording lacks, told from the numbers of those that it has. A scan that saw nothing may be written as a row
//! without a detection, or not at all; then its number is missing.
//!
//! # Method
//! 1. Where two sensors share a number, each sensor counts its own scans: the numbers that its next scan leaves out are missing.
//! 2. Else the scans are counted through all sensors in order of time: numbers are missing that the next scan leaves out above the
//!    highest before it. The first scan of a sensor leaves none out, for it may have begun to count anywhere.
//!
//! For one sensor both are the same.

use super::scan::{RecordingParts, Scan};

/// A place where scan numbers are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gap {
    /// Indices of the scans before and behind.
    pub before: usize,
    pub after: usize,
    /// Numbers between the two that no scan has.
    pub missing: u32,
}

/// Whether each sensor counts its own scans.
pub fn are_by_sensor(scans: &[Scan]) -> bool {
    if scans
        .windows(2)
        .all(|pair| pair[0].sensor == pair[1].sensor)
    {
        return true;
    }
    let mut numbers: Vec<(u32, usize)> = scans
        .iter()
        .map(|scan| (scan.number, scan.sensor))
        .collect();
    numbers.sort_unstable();
    numbers
        .windows(2)
        .any(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1)
}

/// Every gap, in order of the scans behind them.
pub fn gaps(parts: &RecordingParts) -> Vec<Gap> {
    let is_by_sensor = are_by_sensor(&parts.scans);
    // Of each sensor its latest scan.
    let mut latest: Vec<Option<usize>> = vec![None; parts.sensors.len()];
    let mut highest = 0;
    let mut gaps = Vec::new();
    for (after, scan) in parts.scans.iter().enumerate() {
        if let Some(own) = latest[scan.sensor].replace(after) {
            let (before, counted) = if is_by_sensor {
                (own, parts.scans[own].number)
            } else {
                (after - 1, highest)
            };
            let missing = scan.number.saturating_sub(counted).saturating_sub(1);
            if missing > 0 {
                gaps.push(Gap {
                    before,
                    after,
                    missing,
                });
            }
        }
        highest = highest.max(scan.number);
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::super::sensor::SensorSettings;
    use super::*;

    /// Scans by number, time and sensor; the gaps by the numbers around them.
    fn found(scans: &[(u32, f64, usize)]) -> Vec<(u32, u32, u32)> {
        let scan = |&(number, time_s, sensor): &(u32, f64, usize)| Scan {
            number,
            time_s,
            sensor,
            pose: None,
            own: Vec::new(),
            detections: Vec::new(),
        };
        let scans: Vec<Scan> = scans.iter().map(scan).collect();
        let parts = RecordingParts {
            sensors: vec![SensorSettings::named("any"); 3],
            scans,
            ..Default::default()
        };
        gaps(&parts)
            .iter()
            .map(|gap| {
                (
                    parts.scans[gap.before].number,
                    parts.scans[gap.after].number,
                    gap.missing,
                )
            })
            .collect()
    }

    #[test]
    fn one_sensor_lacks_what_its_numbers_leave_out() {
        assert_eq!(
            found(&[(7, 0.0, 0), (8, 1.0, 0), (11, 4.0, 0), (3, 5.0, 0)]),
            [(8, 11, 2)]
        );
        assert_eq!(found(&[]), []);
    }

    #[test]
    fn sensors_that_share_a_number_count_their_own_scans() {
        let shared = [
            (1, 0.0, 0),
            (1, 0.0, 1),
            (2, 1.0, 0),
            (2, 1.0, 1),
            (4, 3.0, 0),
            (5, 4.0, 1),
        ];
        assert_eq!(found(&shared), [(2, 4, 1), (2, 5, 2)]);
    }

    #[test]
    fn scans_that_are_counted_through_lack_what_no_sensor_has() {
        let through = [
            (1, 0.0, 0),
            (2, 0.0, 1),
            (3, 1.0, 0),
            (4, 1.0, 1),
            (6, 2.0, 1),
            (7, 3.0, 0),
        ];
        assert_eq!(found(&through), [(4, 6, 1)]);
        // Sensors whose counts begin far apart.
        assert_eq!(
            found(&[(1, 0.0, 0), (5000, 0.5, 1), (2, 1.0, 0), (5001, 1.5, 1)]),
            []
        );
    }
}
