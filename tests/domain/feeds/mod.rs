//! Feeds decoded: what others found in recordings, published sentences and frames, and files that are broken.

mod ais;
mod ais_recordings;
mod gpx;
mod mode_s;
mod mode_s_recording;

use std::path::PathBuf;
use trackloom_domain::formats::feed::{Feed, Spot};

/// A recording of `TRACKLOOM_DATA`; says so where it is not there.
fn recording(name: &str) -> Option<Vec<u8>> {
    let folder = std::env::var_os("TRACKLOOM_DATA").map(PathBuf::from);
    let path = folder.map(|folder| folder.join(name));
    let bytes = path.and_then(|path| std::fs::read(path).ok());
    if bytes.is_none() {
        println!("skipped: {name} is not in TRACKLOOM_DATA");
    }
    bytes
}

/// Units of reports.
fn used(feed: &Feed) -> u64 {
    feed.reports
        .iter()
        .map(|report| u64::from(report.units))
        .sum()
}

/// Units of any fate.
fn units(feed: &Feed) -> u64 {
    used(feed) + feed.units.ignored_count() + feed.units.rejected_count()
}

fn rejected(feed: &Feed, reason: &str) -> u64 {
    feed.units
        .rejected
        .get(reason)
        .map_or(0, |rejected| rejected.count)
}

fn ignored(feed: &Feed, kind: &str) -> u64 {
    feed.units.ignored.get(kind).copied().unwrap_or(0)
}

fn place(spot: Spot) -> (f64, f64) {
    match spot {
        Spot::Geographic { lat_deg, lon_deg } => (lat_deg, lon_deg),
        other => panic!("{other:?}"),
    }
}

/// Name of the identity of a report.
fn identity(feed: &Feed, report: usize) -> &str {
    feed.identities.name(feed.reports[report].identity.unwrap())
}

fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found}, not {expected}"
    );
}
