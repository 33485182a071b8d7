//! Broken files: sound ones of every format, changed at random, through every reader. None makes a reader panic, every unit of what is
//! read has one fate, and no file makes more rows than it has bytes.
//!
//! `tests/fuzz.sh N` changes N files; `TRACKLOOM_FUZZ_FROM=I TRACKLOOM_FUZZ=1` does change I again.

mod mutate;
mod seeds;

use mutate::Draws;
use seeds::{Seed, seeds};
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use trackloom_domain::formats::{FORMATS, Format, ReadOptions, read_file};
use trackloom_domain::model::dataset::DatasetKind;

/// How many files are changed when nothing else is said.
const CHANGES: u64 = 2000;

/// Gzip makes up to so many bytes of one.
const MOST_TIMES: usize = 1032;

/// What of the environment is a number.
fn told(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Half of the time nothing is said of the file.
fn draw_options(draws: &mut Draws) -> ReadOptions {
    if draws.below(2) == 0 {
        return ReadOptions::default();
    }
    let told: [(&str, Value); 7] = [
        ("start", json!("2026-01-31T12:00:00Z")),
        ("max_rejected", json!(1.0)),
        ("date", json!("2026-01-31")),
        ("identity", json!("drop")),
        ("receiver", json!({"lat_deg": 52.3, "lon_deg": 4.8})),
        ("test_targets", json!(true)),
        ("utc_offset_s", json!(0.0)),
    ];
    let mut options = ReadOptions {
        kind: DatasetKind::ALL.get(draws.below(16)).copied(),
        ..ReadOptions::default()
    };
    let chosen = told.into_iter().filter(|_| draws.below(2) == 0);
    options.options = chosen
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
    options
}

/// Reads the file and checks what comes out; whether anything did.
fn check(bytes: &[u8], format: Option<&'static Format>, options: &ReadOptions) -> bool {
    let mut input = bytes;
    let Ok((read, format)) = read_file("file", &mut input, format, options) else {
        return false;
    };
    let units = &read.units;
    assert_eq!(
        units.used + units.ignored_count() + units.rejected_count(),
        units.total,
        "fates do not add up: {units:?}"
    );
    let is_packed = bytes.starts_with(b"\x1f\x8b") || bytes.starts_with(b"\x28\xb5\x2f\xfd");
    // Columns of one value need no bytes for their rows.
    let is_columnar = ["parquet", "arrow"].contains(&format.name);
    let most = bytes.len() * if is_packed { MOST_TIMES } else { 1 };
    let rows = read.dataset.row_count();
    assert!(
        is_columnar || rows <= most,
        "{rows} rows of {} bytes",
        bytes.len()
    );
    true
}

/// A seed, changed; by the number of the change alone.
fn change(seeds: &[Seed], number: u64) -> (&'static str, Vec<u8>, ReadOptions) {
    let mut draws = Draws::of(number);
    let seed = &seeds[draws.below(seeds.len())];
    let other = &seeds[draws.below(seeds.len())];
    let mut bytes = seed.bytes.clone();
    for _ in 0..=draws.below(3) {
        mutate::once(&mut bytes, &other.bytes, &mut draws);
    }
    let options = draw_options(&mut draws);
    (seed.name, bytes, options)
}

/// Reads one changed file in every way; how many ways gave a dataset.
fn read_in_every_way(seeds: &[Seed], number: u64) -> usize {
    let (name, bytes, options) = change(seeds, number);
    let ways = std::iter::once(None).chain(FORMATS.iter().map(Some));
    let mut read = 0;
    for way in ways {
        let way_name = way.map_or("detection", |format| format.name);
        let checked = catch_unwind(AssertUnwindSafe(|| check(&bytes, way, &options)));
        match checked {
            Ok(is_read) => read += usize::from(is_read),
            Err(_) => panic!(
                "change {number} of {name} by {way_name}, {options:?}: {}",
                bytes.escape_ascii()
            ),
        }
    }
    read
}

#[test]
fn seeds_are_sound() {
    for seed in seeds() {
        let mut input = seed.bytes.as_slice();
        let options = seed.options();
        let read = read_file("file", &mut input, None, &options);
        let (read, format) = read.unwrap_or_else(|faults| panic!("{}: {faults:?}", seed.name));
        assert_eq!(format.name, seed.format, "{}", seed.name);
        let units = &read.units;
        assert!(
            read.units.used > 0 && read.units.rejected.is_empty(),
            "{}: {units:?}",
            seed.name
        );
    }
}

#[test]
fn changed_files_break_no_reader() {
    let seeds = seeds();
    let from = told("TRACKLOOM_FUZZ_FROM").unwrap_or(0);
    let count = told("TRACKLOOM_FUZZ").unwrap_or(CHANGES);
    let mut read = 0;
    for number in from..from + count {
        read += read_in_every_way(&seeds, number);
    }
    println!("{count} changed files gave {read} datasets");
    // A change that no file survives would test nothing but its first bytes.
    assert!(
        count < 100 || read as u64 > count / 20,
        "only {read} of {count}"
    );
}
