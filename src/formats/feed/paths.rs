//! The paths of identities: sorted by time, without repetitions and jumps, begun anew where an identity was silent for long.

use super::{Attribute, Feed, Manner, Report, Spot};
use crate::formats::disorder::Disorder;
use crate::formats::{Reading, Reason};
use crate::geodesy::{SEMI_MAJOR_M, wrap_longitude_deg};
use std::collections::BTreeMap;

/// So many reports that agree with each other begin a new path, however far from the one before.
const AGREEING: usize = 5;

/// Reports of one path, by index, in order of time.
pub(super) struct Path {
    pub identity: u32,
    /// The how-manieth of its identity.
    pub number: usize,
    pub reports: Vec<usize>,
}

/// Divides the reports into paths. What is in none of them is counted: reports without an identity, repetitions, jumps.
pub(super) fn divide(feed: &mut Feed, manner: &Manner, reading: &Reading) -> Vec<Path> {
    let mut order: Vec<usize> = Vec::with_capacity(feed.reports.len());
    let mut nameless = 0;
    for (index, report) in feed.reports.iter().enumerate() {
        match report.identity {
            Some(_) => order.push(index),
            None => nameless += u64::from(report.units),
        }
    }
    if nameless > 0 {
        feed.units.ignore("no identity", nameless);
    }
    tell_disorder(feed, &order);
    let reports = &feed.reports;
    sort_by_identity(&mut order, reports);
    let gap_s = reading.path_gap_s.unwrap_or(manner.path_gap_s);
    let max_speed_mps = reading.max_speed_mps.unwrap_or(manner.max_speed_mps);
    let mut paths = Vec::new();
    let identities: Vec<Option<u32>> = reports.iter().map(|report| report.identity).collect();
    for of_one in order.chunk_by(|&a, &b| identities[a] == identities[b]) {
        let of_one = of_one.to_vec();
        let single = drop_repetitions(feed, of_one);
        let (sound, new_paths) = drop_jumps(feed, single, max_speed_mps);
        split(
            feed,
            sound,
            (&new_paths, gap_s, manner.splits_by_callsign),
            &mut paths,
        );
    }
    paths
}

/// Which reports are rejected since their identity cannot have come there.
pub(super) fn wild(feed: &mut Feed, manner: &Manner, reading: &Reading) -> Vec<bool> {
    let mut order: Vec<usize> = (0..feed.reports.len())
        .filter(|&index| feed.reports[index].identity.is_some())
        .collect();
    sort_by_identity(&mut order, &feed.reports);
    let max_speed_mps = reading.max_speed_mps.unwrap_or(manner.max_speed_mps);
    let identities: Vec<Option<u32>> = feed.reports.iter().map(|report| report.identity).collect();
    let mut is_wild = vec![false; feed.reports.len()];
    order.iter().for_each(|&index| is_wild[index] = true);
    for of_one in order.chunk_by(|&a, &b| identities[a] == identities[b]) {
        let (sound, _) = drop_jumps(feed, of_one.to_vec(), max_speed_mps);
        sound.iter().for_each(|&index| is_wild[index] = false);
    }
    is_wild
}

fn sort_by_identity(order: &mut [usize], reports: &[Report]) {
    order.sort_by(|&a, &b| {
        let (a, b) = (&reports[a], &reports[b]);
        a.identity
            .cmp(&b.identity)
            .then(a.time_s.total_cmp(&b.time_s))
    });
}

impl Report {
    fn says_the_same(&self, other: &Report) -> bool {
        self.spot == other.spot && self.height_m == other.height_m && self.motion == other.motion
    }
}

/// Says how far back in time the largest step of an identity goes, in the order of the file.
fn tell_disorder(feed: &mut Feed, order: &[usize]) {
    let mut disorder = Disorder::default();
    let mut latest_s: BTreeMap<Option<u32>, f64> = BTreeMap::new();
    for &index in order {
        let report = &feed.reports[index];
        let latest_s = latest_s.entry(report.identity).or_insert(f64::NEG_INFINITY);
        disorder.note(latest_s, report.time_s, report.unit);
    }
    feed.warnings.extend(disorder.warning(&feed.units.called));
}

/// Of reports of one identity and time the first is kept.
fn drop_repetitions(feed: &mut Feed, sorted: Vec<usize>) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(sorted.len());
    for index in sorted {
        let report = &feed.reports[index];
        let before = kept.last().map(|&last| &feed.reports[last]);
        match before.filter(|before| before.time_s == report.time_s) {
            None => kept.push(index),
            Some(before) if before.says_the_same(report) => {
                feed.units.ignore("duplicate", u64::from(report.units));
            }
            Some(_) => {
                let (unit, units) = (report.unit, u64::from(report.units));
                feed.units.reject(Reason::Duplicate, unit, units);
            }
        }
    }
    kept
}

/// Rejects reports too far from the one before them, unless enough follow that agree with them; returns the others, and which
/// of those begin a new path.
fn drop_jumps(feed: &mut Feed, sorted: Vec<usize>, max_speed_mps: f64) -> (Vec<usize>, Vec<usize>) {
    let (mut kept, mut begin): (Vec<usize>, Vec<usize>) =
        (Vec::with_capacity(sorted.len()), Vec::new());
    let mut away: Vec<usize> = Vec::new();
    for index in sorted {
        let agrees = |last: Option<&usize>| {
            last.is_none_or(|&last| {
                is_near(&feed.reports[last], &feed.reports[index], max_speed_mps)
            })
        };
        if agrees(kept.last()) {
            reject_jumps(feed, &mut away);
            kept.push(index);
            continue;
        }
        if !agrees(away.last()) {
            reject_jumps(feed, &mut away);
        }
        away.push(index);
        if away.len() == AGREEING {
            begin.push(away[0]);
            kept.append(&mut away);
        }
    }
    reject_jumps(feed, &mut away);
    (kept, begin)
}

fn reject_jumps(feed: &mut Feed, away: &mut Vec<usize>) {
    for index in away.drain(..) {
        let report = &feed.reports[index];
        feed.units
            .reject(Reason::PositionJump, report.unit, u64::from(report.units));
    }
}

/// Whether one can come from the first to the second in time. Times are often of whole seconds: less than one is taken for one.
fn is_near(from: &Report, to: &Report, max_speed_mps: f64) -> bool {
    let time_s = (to.time_s - from.time_s).max(1.0);
    way_m(&from.spot, &to.spot).is_none_or(|way_m| way_m <= max_speed_mps * time_s)
}

/// How far two spots are from each other, on a sphere; of different sorts of spots nobody knows.
fn way_m(from: &Spot, to: &Spot) -> Option<f64> {
    match (from, to) {
        (
            Spot::Geographic { lat_deg, lon_deg },
            Spot::Geographic {
                lat_deg: to_lat_deg,
                lon_deg: to_lon_deg,
            },
        ) => {
            let (lat, to_lat) = (lat_deg.to_radians(), to_lat_deg.to_radians());
            let lon = wrap_longitude_deg(to_lon_deg - lon_deg).to_radians();
            let half = ((to_lat - lat) / 2.0).sin().powi(2)
                + lat.cos() * to_lat.cos() * (lon / 2.0).sin().powi(2);
            Some(2.0 * SEMI_MAJOR_M * half.sqrt().min(1.0).asin())
        }
        (
            Spot::Plane { x_m, y_m },
            Spot::Plane {
                x_m: to_x_m,
                y_m: to_y_m,
            },
        ) => Some((to_x_m - x_m).hypot(to_y_m - y_m)),
        _ => None,
    }
}

fn split(
    feed: &mut Feed,
    sound: Vec<usize>,
    (new_paths, gap_s, by_callsign): (&[usize], f64, bool),
    paths: &mut Vec<Path>,
) {
    let Some(identity) = sound
        .first()
        .and_then(|&first| feed.reports[first].identity)
    else {
        return;
    };
    if !new_paths.is_empty() {
        let (name, count) = (feed.identities.name(identity), new_paths.len());
        feed.warnings.push(format!(
            "'{name}' is elsewhere {count} times, farther than it can have come: its path begins anew there"
        ));
    }
    let first = paths.len();
    let mut callsign: Option<String> = None;
    for index in sound {
        let report = &feed.reports[index];
        let called = if by_callsign {
            feed.callsign_of(index)
        } else {
            None
        };
        let is_other =
            called.is_some_and(|called| callsign.as_deref().is_some_and(|known| known != called));
        let last = paths[first..]
            .last()
            .and_then(|path: &Path| path.reports.last());
        let goes_on = last.is_some_and(|&last| {
            let last = &feed.reports[last];
            report.time_s - last.time_s <= gap_s && !last.ends && !report.begins
        });
        if !goes_on || is_other || new_paths.contains(&index) {
            callsign = None;
            let number = paths.len() - first;
            paths.push(Path {
                identity,
                number,
                reports: Vec::new(),
            });
        }
        if let Some(called) = called.filter(|_| callsign.is_none()) {
            callsign = Some(called.to_owned());
        }
        if let Some(path) = paths.last_mut() {
            path.reports.push(index);
        }
    }
}

impl Feed {
    fn callsign_of(&self, report: usize) -> Option<&str> {
        let said = self
            .said_of(report)
            .find(|(attribute, _)| *attribute == Attribute::Callsign);
        said.map(|(_, text)| text)
    }
}
