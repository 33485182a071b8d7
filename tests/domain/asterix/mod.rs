//! ASTERIX: real recordings where they are at hand, files that the encoder wrote, and files that are broken.

mod broken;
mod categories;
mod encoder;
mod framings;
mod judges;
mod recordings;
mod samples;

use std::collections::BTreeMap;
use trackloom_domain::formats::asterix::{Decoded, Told, decode};
use trackloom_domain::formats::feed::Attribute;
use trackloom_domain::model::fault::Fault;

fn read(bytes: &[u8], told: &Told) -> Result<Decoded, Vec<Fault>> {
    decode(&mut &bytes[..], told)
}

/// Reads a file that is sound.
fn sound(bytes: &[u8], told: &Told) -> Decoded {
    read(bytes, told).unwrap_or_else(|faults| panic!("{faults:?}"))
}

/// What is ignored, by kind.
fn ignored(decoded: &Decoded) -> BTreeMap<&str, u64> {
    let kinds = decoded.feed.units.ignored.iter();
    kinds.map(|(kind, count)| (kind.as_str(), *count)).collect()
}

/// What is rejected, by reason.
fn rejected(decoded: &Decoded) -> BTreeMap<&str, u64> {
    let reasons = decoded.feed.units.rejected.iter();
    reasons
        .map(|(reason, rejected)| (reason.as_str(), rejected.count))
        .collect()
}

/// What is said of a report, by column.
fn said(decoded: &Decoded, report: usize) -> BTreeMap<&'static str, String> {
    let of_it = decoded.feed.said_of(report);
    of_it
        .map(|(attribute, text)| (Attribute::name(attribute), text.to_owned()))
        .collect()
}

/// Every unit has one fate, and each report a number of its own; returns how many units there are.
fn units(decoded: &Decoded) -> u64 {
    let feed = &decoded.feed;
    let total = feed.units.total + feed.reports.len() as u64;
    assert_eq!(
        feed.units.total,
        feed.units.ignored_count() + feed.units.rejected_count()
    );
    let numbers: Vec<u64> = feed.reports.iter().map(|report| report.unit).collect();
    assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
    assert!(
        numbers.iter().all(|number| (1..=total).contains(number)),
        "{numbers:?} of {total}"
    );
    let named = feed
        .units
        .rejected
        .values()
        .flat_map(|rejected| &rejected.first);
    assert!(named.into_iter().all(|number| (1..=total).contains(number)));
    total
}
