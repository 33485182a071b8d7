//! What other programs read of what the encoder writes: `tests/formats/read_asterix.py` reads the files that this leaves.

use super::samples::{adsb, plot, track};
use proptest::collection::vec;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use serde_json::{Value, json};
use std::path::Path;
use trackloom_domain::formats::asterix::encode::{
    AdsbRecord, MarkRecord, PlotRecord, TrackRecord, encode_adsb, encode_marks, encode_plots,
    encode_plots_001, encode_tracks,
};
use trackloom_domain::formats::feed::Site;

const RECORDS: usize = 500;

fn drawn<T: std::fmt::Debug>(strategy: impl Strategy<Value = T>) -> Vec<T> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    vec(strategy, RECORDS)
        .new_tree(&mut runner)
        .unwrap()
        .current()
}

fn track_values(point: &TrackRecord) -> Value {
    json!({
        "source": point.source, "time_s": point.time_s, "number": point.number,
        "lat_deg": point.lat_deg, "lon_deg": point.lon_deg, "place_m": point.place_m,
        "velocity_mps": point.velocity_mps, "covariance_m2": point.covariance_m2,
        "velocity_sigma_mps": point.velocity_sigma_mps,
        "pressure_altitude_m": point.pressure_altitude_m,
        "geometric_altitude_m": point.geometric_altitude_m,
        "vertical_rate_mps": point.vertical_rate_mps, "status": point.status.name(),
        "begins": point.begins, "ends": point.ends, "address": point.address,
        "callsign": point.callsign, "mode_a": point.mode_a,
    })
}

fn plot_values(plot: &PlotRecord) -> Value {
    json!({
        "source": plot.source, "time_s": plot.time_s, "place": plot.place,
        "detection": plot.detection, "is_tentative": plot.is_tentative, "ends": plot.ends,
        "mode_a": plot.mode_a, "level_ft": plot.level_ft, "address": plot.address,
        "callsign": plot.callsign, "number": plot.number,
        "motion": plot.motion.map(|motion| (motion.speed_mps, motion.course_rad)),
    })
}

fn adsb_values(report: &AdsbRecord) -> Value {
    json!({
        "source": report.source, "time_s": report.time_s, "address": report.address,
        "lat_deg": report.lat_deg, "lon_deg": report.lon_deg,
        "geometric_altitude_m": report.geometric_altitude_m, "level_ft": report.level_ft,
        "motion": report.motion.map(|motion| (motion.speed_mps, motion.course_rad)),
        "nacp": report.nacp, "is_on_ground": report.is_on_ground,
        "callsign": report.callsign, "mode_a": report.mode_a,
    })
}

fn marks() -> Vec<MarkRecord> {
    let site = Site {
        lat_deg: 43.571,
        lon_deg: -16.406,
        height_m: -12.0,
    };
    let mark = |index: u16| MarkRecord {
        source: (25, 12),
        time_s: f64::from(index),
        kind: if index.is_multiple_of(32) { 1 } else { 2 },
        sector: Some((index % 32 * 8) as u8),
        rotation_s: Some(4.9453125),
        site: index.is_multiple_of(32).then_some(site),
    };
    (0..64).map(mark).collect()
}

fn mark_values(mark: &MarkRecord) -> Value {
    json!({
        "source": mark.source, "time_s": mark.time_s, "kind": mark.kind, "sector": mark.sector,
        "rotation_s": mark.rotation_s,
        "site": mark.site.map(|site| (site.lat_deg, site.lon_deg, site.height_m)),
    })
}

#[test]
fn files_for_other_programs() {
    let Some(folder) = std::env::var_os("TRACKLOOM_ASTERIX_OUT") else {
        println!("skipped: TRACKLOOM_ASTERIX_OUT names no folder to write to");
        return;
    };
    let write = |name: &str, blocks: Vec<u8>, values: Vec<Value>| {
        let path = Path::new(&folder).join(name);
        std::fs::write(path.with_extension("ast"), blocks).unwrap();
        std::fs::write(
            path.with_extension("json"),
            Value::Array(values).to_string(),
        )
        .unwrap();
    };
    let mut points = drawn(track());
    points
        .iter_mut()
        .enumerate()
        .for_each(|(index, point)| point.time_s = index as f64 * 17.25);
    write(
        "062",
        encode_tracks(&points),
        points.iter().map(track_values).collect(),
    );
    let mut plots = drawn(plot());
    plots
        .iter_mut()
        .enumerate()
        .for_each(|(index, plot)| plot.time_s = index as f64 * 17.25);
    write(
        "048",
        encode_plots(&plots),
        plots.iter().map(plot_values).collect(),
    );
    plots.iter_mut().for_each(|plot| plot.detection %= 4);
    write(
        "001",
        encode_plots_001(&plots),
        plots.iter().map(plot_values).collect(),
    );
    let mut reports = drawn(adsb());
    reports
        .iter_mut()
        .enumerate()
        .for_each(|(index, report)| report.time_s = index as f64 * 17.25);
    write(
        "021",
        encode_adsb(&reports),
        reports.iter().map(adsb_values).collect(),
    );
    let marks = marks();
    write(
        "034",
        encode_marks(&marks),
        marks.iter().map(mark_values).collect(),
    );
}
