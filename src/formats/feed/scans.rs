//! The scans of reports that come one by one: turns of an antenna, or frames of a stated period.

use super::{Feed, Spot};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// A sensor that turns, and says when.
#[derive(Debug, Clone, Copy)]
struct Turn {
    north_s: f64,
    period_s: f64,
}

/// Which scan of its sensor each report is of; reports are given in order of time by index. A radar's are divided by the turns of its antenna: at its north marks, else
/// where its bearings fall by more than half a turn. Others are gathered in frames that begin at multiples of `frame_s`.
pub(super) fn divide(feed: &Feed, order: &[usize], frame_s: f64) -> Vec<i64> {
    let turns = turns_of(feed);
    let mut of = vec![0; feed.reports.len()];
    // Of sensors that say nothing of their turns: the scan, and the bearing before.
    let mut latest: BTreeMap<u32, (i64, f64)> = BTreeMap::new();
    for &index in order {
        let report = &feed.reports[index];
        let scan = match (report.spot, turns.get(&report.sensor)) {
            (Spot::Polar { .. }, Some(turn)) => {
                ((report.time_s - turn.north_s) / turn.period_s).floor() as i64
            }
            (Spot::Polar { bearing_rad, .. }, None) => {
                let (scan, before_rad) = latest.entry(report.sensor).or_insert((0, bearing_rad));
                *scan += i64::from(*before_rad - bearing_rad > PI);
                *before_rad = bearing_rad;
                *scan
            }
            _ => (report.time_s / frame_s).floor() as i64,
        };
        of[index] = scan;
    }
    of
}

/// Of each sensor that passes north at known times, at regular ones.
fn turns_of(feed: &Feed) -> BTreeMap<u32, Turn> {
    let mut marks: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for &(sensor, time_s) in &feed.north_s {
        marks.entry(sensor).or_default().push(time_s);
    }
    let mut turns = BTreeMap::new();
    for (sensor, mut times_s) in marks {
        times_s.sort_by(f64::total_cmp);
        let period_s = feed
            .rotation_s
            .get(&sensor)
            .copied()
            .or_else(|| shortest_gap_s(&times_s));
        if let Some(period_s) = period_s.filter(|period_s| *period_s > 0.0) {
            let north_s = times_s[0];
            turns.insert(sensor, Turn { north_s, period_s });
        }
    }
    turns
}

fn shortest_gap_s(sorted_s: &[f64]) -> Option<f64> {
    let gaps = sorted_s.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.filter(|gap_s| *gap_s > 0.0).min_by(f64::total_cmp)
}
