//! Real files from end to end: what is counted, and where and when the first and the last row are. Skipped where the files are not in
//! `TRACKLOOM_DATA`. Counts and values are those of other programs: pandas, pyais, pyModeS, rs1090, asterix_decoder, libasterix,
//! and the `json` of Python.

mod asterix;
mod feeds;
mod plane;
mod tables;

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::PathBuf;
use trackloom_domain::formats::{ReadOptions, ReadOutcome, Units, read_file};
use trackloom_domain::geodesy::Stereographic;
use trackloom_domain::model::dataset::{Dataset, DatasetKind};
use trackloom_domain::model::fault::Fault;
use trackloom_domain::model::space::{Frame, Place};

/// How well a time (s) and a place (degrees) agree with what another program has.
const TIME_S: f64 = 1e-6;
const DEGREE: f64 = 1e-8;
/// Of places that another program rounds to six digits.
const SIX_DIGITS: f64 = 5.1e-7;

/// A row: the name of its object, its time (s), latitude and longitude (degrees).
type Row<'a> = (&'a str, f64, f64, f64);

/// Reads a file with what a user says of it; `None` where it is not at hand, and says so.
fn try_read(name: &str, said: &[(&str, Value)]) -> Option<Result<ReadOutcome, Vec<Fault>>> {
    let folder = std::env::var_os("TRACKLOOM_DATA").map(PathBuf::from);
    let path = folder.map(|folder| folder.join(name));
    let Some(bytes) = path.and_then(|path| std::fs::read(path).ok()) else {
        println!("skipped: {name} is not in TRACKLOOM_DATA");
        return None;
    };
    let kind = said.iter().find(|(name, _)| *name == "kind");
    let kind = kind.and_then(|(_, kind)| {
        let named = |known: &DatasetKind| Some(known.name()) == kind.as_str();
        DatasetKind::ALL.into_iter().find(named)
    });
    let others = said.iter().filter(|(name, _)| *name != "kind");
    let others = others.map(|(name, value)| ((*name).to_owned(), value.clone()));
    let options = ReadOptions {
        kind,
        options: others.collect(),
        ..ReadOptions::default()
    };
    let file_name = name.rsplit('/').next().unwrap_or(name);
    let read = read_file(file_name, &mut bytes.as_slice(), None, &options);
    Some(read.map(|(outcome, _)| outcome))
}

/// Reads a file that is sound, whose units all have one fate.
pub(crate) fn read(name: &str, said: &[(&str, Value)]) -> Option<ReadOutcome> {
    let read = try_read(name, said)?.unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
    let units = &read.units;
    assert_eq!(
        units.used + units.ignored_count() + units.rejected_count(),
        units.total,
        "{name}"
    );
    assert_eq!(read.dataset.row_count() as u64, units.used, "{name}");
    Some(read)
}

fn ignored(units: &Units, kind: &str) -> u64 {
    units.ignored.get(kind).copied().unwrap_or(0)
}

fn rejected(units: &Units, reason: &str) -> u64 {
    units
        .rejected
        .get(reason)
        .map_or(0, |rejected| rejected.count)
}

/// Total, used, ignored and rejected.
fn fates(read: &ReadOutcome) -> [u64; 4] {
    let units = &read.units;
    [
        units.total,
        units.used,
        units.ignored_count(),
        units.rejected_count(),
    ]
}

/// Points of truth or tracks: the name of their object, time and place.
fn points(dataset: &Dataset) -> Vec<(&str, f64, Place)> {
    match dataset {
        Dataset::Truth(truth) => {
            let targets = truth.targets().iter();
            let of_one = targets.flat_map(|target| {
                let points = target.points.iter();
                points.map(|point| (target.truth_id.as_str(), point.time_s, point.position))
            });
            of_one.collect()
        }
        Dataset::Tracks(set) => {
            let of_one = set.tracks.iter().flat_map(|track| {
                let points = track.points.iter();
                points.map(|point| {
                    (
                        track.track_id.as_str(),
                        point.time_s,
                        point.estimate.position,
                    )
                })
            });
            of_one.collect()
        }
        _ => panic!("neither truth nor tracks"),
    }
}

/// The identity of a path: `4baac6` of `4baac6-3`.
fn identity(path: &str) -> &str {
    path.split_once('-').map_or(path, |(identity, _)| identity)
}

/// How many identities, and how many paths of them.
fn identities_and_paths(dataset: &Dataset) -> [usize; 2] {
    let points = points(dataset);
    let paths: BTreeSet<&str> = points.iter().map(|point| point.0).collect();
    let identities: BTreeSet<&str> = paths.iter().map(|path| identity(path)).collect();
    [identities.len(), paths.len()]
}

/// The first time and the last one.
fn span_s(dataset: &Dataset) -> [f64; 2] {
    let summary = dataset.summary();
    [summary.start_s.unwrap(), summary.end_s.unwrap()]
}

fn plane(frame: Option<Frame>) -> Stereographic {
    let frame = frame.expect("places of the Earth have an origin");
    Stereographic::about(frame.latitude_deg(), frame.longitude_deg())
}

/// Asserts that an object was at a place at a time.
fn assert_row(dataset: &Dataset, row: Row, tolerance_deg: f64) {
    let (name, time_s, lat_deg, lon_deg) = row;
    let plane = plane(dataset.frame());
    let points = points(dataset);
    let mut of_time = points.iter().filter(|point| {
        let is_of_it = point.0 == name || identity(point.0) == name;
        is_of_it && (point.1 - time_s).abs() <= TIME_S
    });
    let (_, _, place) = of_time
        .next()
        .unwrap_or_else(|| panic!("no row of {row:?}"));
    let (found_lat_deg, found_lon_deg) = plane.unproject(&place.xy());
    assert!(
        (found_lat_deg - lat_deg).abs() <= tolerance_deg
            && (found_lon_deg - lon_deg).abs() <= tolerance_deg,
        "{found_lat_deg} {found_lon_deg}, not {row:?}"
    );
}
