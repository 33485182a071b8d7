//! Reports gathered in scans as they come. A scan is whole when its sensor's data are later than its end, or when nothing was added
//! to it for so long. What comes after its scan was told is a scan of its own: late, as a session takes it.

use super::{LiveReport, ScanKey, ScanKind};
use crate::model::scan::{Detection, mean_time_s};
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// Reports that are kept at most; beyond it scans are told before they are whole.
const MOST_KEPT: usize = 100_000;
/// How long the reports of a turn, or of a scan that the stream numbers, may be apart (s).
const SPARSE_S: f64 = 15.0;

/// How long the reports of one time may be apart by the clock (s).
const TOGETHER_S: f64 = 0.25;

/// A scan that is whole.
#[derive(Debug, Clone, PartialEq)]
pub struct GatheredScan {
    pub sensor: Arc<str>,
    pub time_s: f64,
    /// With their identities.
    pub detections: Vec<(String, Detection)>,
    /// Number of its first unit.
    pub unit: u64,
    /// Units of reports that a later one of the same identity replaces.
    pub superseded: u64,
}

/// Gathers the reports of one stream.
pub struct Gatherer {
    frame_s: f64,
    /// How long a scan waits for more: by its sensor's data, or by the clock (s).
    settle_s: f64,
    open: BTreeMap<(Arc<str>, ScanKey), Open>,
    kept: usize,
    /// The latest scan and time of each sensor.
    latest: BTreeMap<Arc<str>, (ScanKey, f64)>,
}

struct Open {
    reports: Vec<LiveReport>,
    /// By the clock.
    added_s: f64,
}

impl Gatherer {
    pub fn new(frame_s: f64, settle_s: f64) -> Self {
        Gatherer {
            frame_s,
            settle_s,
            open: BTreeMap::new(),
            kept: 0,
            latest: BTreeMap::new(),
        }
    }

    /// Takes a report that came at a time by the clock (s).
    pub fn take(&mut self, report: LiveReport, now_s: f64) {
        let first = (report.scan, report.time_s);
        let latest = self.latest.entry(report.sensor.clone()).or_insert(first);
        latest.0 = latest.0.max(report.scan);
        latest.1 = latest.1.max(report.time_s);
        let key = (report.sensor.clone(), report.scan);
        let open = self.open.entry(key).or_insert(Open {
            reports: Vec::new(),
            added_s: now_s,
        });
        open.added_s = now_s;
        open.reports.push(report);
        self.kept += 1;
    }

    /// The scans that are whole at a time by the clock (s), in order.
    pub fn whole(&mut self, now_s: f64) -> Vec<GatheredScan> {
        let is_full = self.kept > MOST_KEPT;
        let mut due = Vec::new();
        for (key, open) in &self.open {
            if is_full || self.is_whole(key, open, now_s) {
                due.push(key.clone());
            }
        }
        self.close(due)
    }

    /// All scans: nothing follows.
    pub fn end(&mut self) -> Vec<GatheredScan> {
        let all = self.open.keys().cloned().collect();
        self.close(all)
    }

    fn is_whole(&self, (sensor, scan): &(Arc<str>, ScanKey), open: &Open, now_s: f64) -> bool {
        let last_s = open.reports.iter().map(|report| report.time_s);
        let last_s = last_s.fold(f64::NEG_INFINITY, f64::max);
        let (end_s, pause_s) = match scan.kind {
            ScanKind::Frame => ((scan.number + 1) as f64 * self.frame_s, self.frame_s),
            ScanKind::Turn | ScanKind::Numbered => (last_s, SPARSE_S),
            ScanKind::Instant => (last_s, TOGETHER_S),
        };
        let is_passed = self
            .latest
            .get(sensor)
            .is_some_and(|(latest, newest_s)| latest > scan && *newest_s >= end_s + self.settle_s);
        is_passed || now_s - open.added_s >= pause_s + self.settle_s
    }

    fn close(&mut self, keys: Vec<(Arc<str>, ScanKey)>) -> Vec<GatheredScan> {
        let mut scans = Vec::with_capacity(keys.len());
        for key in keys {
            if let Some(open) = self.open.remove(&key) {
                self.kept -= open.reports.len();
                scans.push(gathered(open.reports));
            }
        }
        // Those of a sensor stay in their order.
        scans.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        scans
    }
}

/// A scan of reports, of which there is one at least.
fn gathered(mut reports: Vec<LiveReport>) -> GatheredScan {
    reports.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let superseded = drop_superseded(&mut reports);
    let times_s: Vec<f64> = reports.iter().map(|report| report.time_s).collect();
    let units = reports.iter().map(|report| report.unit);
    let mut scan = GatheredScan {
        sensor: reports[0].sensor.clone(),
        time_s: mean_time_s(&times_s),
        unit: units.min().unwrap_or_default(),
        detections: Vec::with_capacity(reports.len()),
        superseded,
    };
    for report in reports {
        let detection = report.detection.map(|one| (report.detection_id, one));
        scan.detections.extend(detection);
    }
    scan
}

/// Of an identity's reports the last is kept; tells of how many units the others are.
fn drop_superseded(reports: &mut Vec<LiveReport>) -> u64 {
    let mut seen = HashSet::new();
    let mut dropped = 0;
    let mut kept = Vec::with_capacity(reports.len());
    for report in std::mem::take(reports).into_iter().rev() {
        if report.identity.is_none_or(|identity| seen.insert(identity)) {
            kept.push(report);
        } else {
            dropped += u64::from(report.units);
        }
    }
    kept.reverse();
    *reports = kept;
    dropped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan::Measurement;

    fn report(scan: (ScanKind, i64), time_s: f64, identity: Option<u32>) -> LiveReport {
        let measurement = Measurement::Position {
            x_m: time_s,
            y_m: 0.0,
        };
        LiveReport {
            sensor: Arc::from("s"),
            scan: ScanKey {
                number: scan.1,
                kind: scan.0,
            },
            time_s,
            detection: Some(Detection {
                measurement,
                origin: None,
                amplitude: None,
            }),
            detection_id: format!("at {time_s}"),
            identity,
            unit: time_s as u64,
            units: 1,
        }
    }

    fn told(scans: &[GatheredScan]) -> Vec<(f64, usize)> {
        let told = |scan: &GatheredScan| (scan.time_s, scan.detections.len());
        scans.iter().map(told).collect()
    }

    #[test]
    fn a_frame_is_whole_when_its_data_are_past_or_the_clock_is() {
        let mut gatherer = Gatherer::new(10.0, 1.0);
        let frame = |number| (ScanKind::Frame, number);
        for time_s in [1.0, 3.0] {
            gatherer.take(report(frame(0), time_s, Some(time_s as u32)), 0.0);
        }
        gatherer.take(report(frame(1), 10.5, Some(1)), 0.0);
        assert_eq!(told(&gatherer.whole(0.0)), []);
        gatherer.take(report(frame(0), 8.0, Some(1)), 0.0);
        gatherer.take(report(frame(1), 11.0, Some(2)), 0.0);
        let first = gatherer.whole(0.0);
        assert_eq!(told(&first), [(5.5, 2)], "the last report of 1 is kept");
        assert_eq!((first[0].superseded, first[0].unit), (1, 3));
        assert_eq!(told(&gatherer.whole(10.9)), []);
        assert_eq!(told(&gatherer.whole(11.0)), [(10.75, 2)]);
        // Late: a scan of its own, as soon as it comes.
        gatherer.take(report(frame(0), 9.0, Some(7)), 11.0);
        assert_eq!(told(&gatherer.whole(11.0)), [(9.0, 1)]);
        assert_eq!((gatherer.end().len(), gatherer.kept), (0, 0));
    }

    #[test]
    fn rows_of_one_time_are_a_scan_when_another_time_comes() {
        let mut gatherer = Gatherer::new(10.0, 0.0);
        let instant = |number| (ScanKind::Instant, number);
        gatherer.take(report(instant(1), 2.0, None), 0.0);
        gatherer.take(report(instant(1), 2.0, None), 0.0);
        gatherer.take(report(instant(2), 4.0, None), 0.0);
        assert_eq!(told(&gatherer.whole(0.0)), [(2.0, 2)]);
        assert_eq!(told(&gatherer.whole(0.2)), []);
        assert_eq!(told(&gatherer.whole(0.3)), [(4.0, 1)]);
    }

    #[test]
    fn a_scan_without_end_is_told_before_memory_ends() {
        let mut gatherer = Gatherer::new(10.0, 1.0);
        for _ in 0..=MOST_KEPT {
            gatherer.take(report((ScanKind::Numbered, 1), 1.0, None), 0.0);
        }
        assert_eq!(gatherer.whole(0.0).len(), 1);
        assert_eq!(gatherer.kept, 0);
    }
}
