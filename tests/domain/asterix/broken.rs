//! Files broken anywhere, and octets at random: refused, or every unit has its fate.

use super::{read, rejected, sound, units};
use proptest::prelude::*;
use std::collections::BTreeMap;
use trackloom_domain::formats::asterix::Told;
use trackloom_domain::formats::asterix::encode::{
    AdsbRecord, MarkRecord, encode_adsb, encode_marks,
};

fn report(time_s: f64) -> AdsbRecord {
    AdsbRecord {
        source: (1, 2),
        time_s,
        address: 0x3c660c,
        lat_deg: 48.5,
        lon_deg: 11.25,
        geometric_altitude_m: Some(10_000.0),
        level_ft: Some(33_000.0),
        motion: None,
        nacp: Some(8),
        is_on_ground: false,
        callsign: Some("DLH65A".to_owned()),
        mode_a: Some(0o1000),
    }
}

fn small_file() -> Vec<u8> {
    let reports: Vec<AdsbRecord> = (0..20).map(|index| report(f64::from(index))).collect();
    let mark = MarkRecord {
        source: (1, 2),
        time_s: 3.0,
        kind: 1,
        sector: Some(0),
        rotation_s: Some(4.0),
        site: None,
    };
    [encode_adsb(&reports), encode_marks(&[mark])].concat()
}

/// Reads it if it can be; its units then have their fates.
fn try_each_kind(bytes: &[u8]) {
    use trackloom_domain::model::dataset::DatasetKind;
    for kind in [None, Some(DatasetKind::Tracks), Some(DatasetKind::Truth)] {
        for edition in ["2.7", "0.26"] {
            let told = Told {
                kind,
                editions: BTreeMap::from([("021".to_owned(), edition.to_owned())]),
                with_test_targets: true,
                ..Told::default()
            };
            if let Ok(decoded) = read(bytes, &told) {
                let total = units(&decoded);
                assert!(
                    total <= bytes.len() as u64,
                    "{total} units of {}",
                    bytes.len()
                );
            }
        }
    }
}

#[test]
fn every_prefix_is_refused_or_has_its_fates() {
    let file = small_file();
    assert_eq!(units(&sound(&file, &Told::default())), 21);
    for end in 0..file.len() {
        try_each_kind(&file[..end]);
    }
}

#[test]
fn every_bit_may_flip() {
    let file = small_file();
    for bit in 0..file.len() * 8 {
        let mut broken = file.clone();
        broken[bit / 8] ^= 1 << (bit % 8);
        if let Ok(decoded) = read(&broken, &Told::default()) {
            assert!(units(&decoded) >= 1);
        }
    }
}

/// Each block here holds records of its own, so that a broken one does not hide others.
#[test]
fn a_broken_record_ends_its_block_alone() {
    let mut file = Vec::new();
    for index in 0..200 {
        let block = encode_adsb(&[report(f64::from(index)), report(f64::from(index) + 0.5)]);
        file.extend(block);
    }
    let length = file.len() / 200;
    // The presence bits of the second record of the seventh block.
    let second = 6 * length + 3 + (length - 3) / 2;
    file[second..second + 7].fill(0xff);
    let decoded = sound(&file, &Told::default());
    assert_eq!(decoded.feed.reports.len(), 399);
    assert_eq!(rejected(&decoded).values().sum::<u64>(), 1);
    let rejected = decoded.feed.units.rejected.values().next().unwrap();
    assert_eq!(rejected.first, [14]);
}

/// Field 20 of plots of category 001 is random field sequencing.
#[test]
fn random_field_sequencing_is_not_read() {
    let sequence: [u8; 9] = [1, 0, 9, 0x81, 0x01, 0x04, 25, 1, 0];
    let faults = read(&sequence, &Told::default())
        .err()
        .expect("it cannot be read");
    assert_eq!(faults[0].code, "unsupported_edition");
}

#[test]
fn editions_that_are_not_known_are_refused() {
    for (category, edition) in [("021", "0.1"), ("62", "0.17"), ("x", "1.0"), ("999", "1.0")] {
        let told = Told {
            editions: BTreeMap::from([(category.to_owned(), edition.to_owned())]),
            ..Told::default()
        };
        let faults = read(&small_file(), &told).err().expect("nobody knows it");
        assert_eq!(
            (faults.len(), faults[0].code.as_str()),
            (1, "unknown_value")
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn octets_at_random_are_refused_or_have_their_fates(
        octets in proptest::collection::vec(any::<u8>(), 0..600),
    ) {
        try_each_kind(&octets);
    }

    /// Blocks of a category that is read, with records at random, in each framing and link.
    #[test]
    fn records_at_random_are_refused_or_have_their_fates(
        category in proptest::sample::select(vec![1u8, 2, 10, 11, 20, 21, 34, 48, 62, 65, 99]),
        head in proptest::collection::vec(any::<u8>(), 1..4),
        rest in proptest::collection::vec(any::<u8>(), 1..200),
    ) {
        let records = [head, rest].concat();
        let length = (records.len() as u16 + 3).to_be_bytes();
        let block = [&[category][..], &length, &records].concat();
        try_each_kind(&block);
        let framed = [&(block.len() as u16 + 6).to_be_bytes()[..], &[0, 0, 1, 0], &block].concat();
        try_each_kind(&framed);
    }

    #[test]
    fn captures_at_random_are_refused_or_have_their_fates(
        magic in proptest::sample::select(vec![
            vec![0xd4, 0xc3, 0xb2, 0xa1], vec![0xa1, 0xb2, 0x3c, 0x4d], vec![0x0a, 0x0d, 0x0d, 0x0a],
        ]),
        link in 0u8..120,
        rest in proptest::collection::vec(prop_oneof![Just(0u8), Just(17), Just(0x45), any::<u8>()], 0..400),
    ) {
        let head = [&magic[..], &[0, 0, 0, 28, 0x1a, 0x2b, 0x3c, 0x4d], &[0; 8], &[0, 0, 0, link]];
        try_each_kind(&[&head.concat()[..], &rest].concat());
    }
}
