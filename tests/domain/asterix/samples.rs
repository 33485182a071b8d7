//! Values to be written, drawn by proptest within what their items can say.

use proptest::prelude::*;
use trackloom_domain::formats::asterix::encode::{AdsbRecord, PlotRecord, TrackRecord};
use trackloom_domain::formats::feed::Motion;
use trackloom_domain::model::track::TrackStatus;

const NM: f64 = 1852.0;

fn callsign() -> impl Strategy<Value = Option<String>> {
    proptest::option::of("[A-Z][A-Z0-9]{2,7}")
}

fn code() -> impl Strategy<Value = Option<u16>> {
    proptest::option::of(0u16..0o10000)
}

fn address() -> impl Strategy<Value = Option<u32>> {
    proptest::option::of(0u32..1 << 24)
}

fn motion() -> impl Strategy<Value = Option<Motion>> {
    let motion = (0.0..900.0, 0.0..6.25).prop_map(|(speed_mps, course_rad)| Motion {
        speed_mps,
        course_rad,
    });
    proptest::option::of(motion)
}

fn pair(range: std::ops::Range<f64>) -> impl Strategy<Value = Option<(f64, f64)>> {
    proptest::option::of((range.clone(), range))
}

/// Standard deviations and correlation as a covariance.
fn covariance() -> impl Strategy<Value = Option<[f64; 3]>> {
    let drawn = (1.0..5000.0, 1.0..5000.0, -0.99..0.99);
    let packed = drawn.prop_map(|(x, y, r): (f64, f64, f64)| [x * x, r * x * y, y * y]);
    proptest::option::of(packed)
}

pub fn track() -> impl Strategy<Value = TrackRecord> {
    let status = prop_oneof![
        Just(TrackStatus::Tentative),
        Just(TrackStatus::Confirmed),
        Just(TrackStatus::Coasted)
    ];
    let head = (
        any::<(u8, u8)>(),
        any::<u16>(),
        -90.0..=90.0,
        -179.99..180.0,
        status,
    );
    let motion = (
        pair(-2e6..2e6),
        pair(-1000.0..1000.0),
        covariance(),
        pair(0.0..60.0),
        proptest::option::of(-300.0..20_000.0),
        proptest::option::of(-400.0..40_000.0),
        proptest::option::of(-100.0..100.0),
    );
    let names = (address(), callsign(), code(), any::<(bool, bool)>());
    (head, motion, names).prop_map(|(head, motion, names)| TrackRecord {
        source: head.0,
        time_s: 0.0,
        number: head.1,
        lat_deg: head.2,
        lon_deg: head.3,
        place_m: motion.0,
        velocity_mps: motion.1,
        covariance_m2: motion.2,
        velocity_sigma_mps: motion.3,
        pressure_altitude_m: motion.4,
        geometric_altitude_m: motion.5,
        vertical_rate_mps: motion.6,
        status: head.4,
        begins: names.3.0,
        ends: names.3.1,
        address: names.0,
        callsign: names.1,
        mode_a: names.2,
    })
}

pub fn plot() -> impl Strategy<Value = PlotRecord> {
    let head = (any::<(u8, u8)>(), (0.0..255.9 * NM, 0.0..6.25), 1u8..=7);
    let flags = (any::<(bool, bool)>(), proptest::option::of(0u16..1 << 12));
    let names = (
        address(),
        callsign(),
        code(),
        motion(),
        proptest::option::of(-10..=5000i32),
    );
    (head, flags, names).prop_map(|(head, flags, names)| PlotRecord {
        source: head.0,
        time_s: 0.0,
        place: Some(head.1),
        detection: head.2,
        is_simulated: false,
        is_test: false,
        is_tentative: flags.0.0,
        ends: flags.0.1,
        mode_a: names.2,
        level_ft: names.4.map(|quarters| f64::from(quarters) * 25.0),
        address: names.0,
        callsign: names.1,
        number: flags.1,
        motion: names.3,
    })
}

pub fn adsb() -> impl Strategy<Value = AdsbRecord> {
    let head = (
        any::<(u8, u8)>(),
        0u32..1 << 24,
        -90.0..=90.0,
        -179.99..180.0,
    );
    let rest = (
        proptest::option::of(-400.0..40_000.0),
        proptest::option::of(-40..=5000i32),
        motion(),
        proptest::option::of(0u8..16),
        any::<bool>(),
        callsign(),
        code(),
    );
    (head, rest).prop_map(|(head, rest)| AdsbRecord {
        source: head.0,
        time_s: 0.0,
        address: head.1,
        lat_deg: head.2,
        lon_deg: head.3,
        geometric_altitude_m: rest.0,
        level_ft: rest.1.map(|quarters| f64::from(quarters) * 25.0),
        motion: rest.2,
        nacp: rest.3,
        is_on_ground: rest.4,
        callsign: rest.5,
        mode_a: rest.6,
    })
}
