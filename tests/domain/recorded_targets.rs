//! Recorded traffic played to a simulated radar: the table of docs/recordings.md.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, plan};

/// A recording and what sees it.
struct Played {
    file: &'static str,
    /// As the page names it.
    words: &'static str,
    scans: u32,
    scan_period_s: f64,
    start_s: f64,
    max_gap_s: f64,
    radar: Value,
    filter: Value,
    tracker: Value,
    gate_m: f64,
}

fn radar(place: (f64, f64), max_range_m: f64, noise: (f64, f64), clutter_per_scan: f64) -> Value {
    json!({
        "sensor_id": "radar", "lat_deg": place.0, "lon_deg": place.1, "max_range_m": max_range_m, "p_d": 0.9,
        "sigma_range_m": noise.0, "sigma_bearing_deg": noise.1, "clutter_per_scan": clutter_per_scan
    })
}

fn tracker(speed_mps: f64, confirm: (u32, u32), max_missed: u32) -> Value {
    json!({
        "initial_speed_sigma_mps": speed_mps, "confirm_hits": confirm.0, "confirm_window": confirm.1, "max_missed": max_missed
    })
}

fn unscented(process_noise_m2ps3: f64) -> Value {
    json!({"method": "unscented", "process_noise_m2ps3": process_noise_m2ps3})
}

fn switzerland() -> Played {
    Played {
        file: "adsb-traffic/switzerland.json.gz",
        words: "traffic over Switzerland, from 10:00 | 300 of 4 s",
        scans: 300,
        scan_period_s: 4.0,
        start_s: 1_533_117_600.0,
        max_gap_s: 120.0,
        radar: radar((46.8, 8.2), 150_000.0, (70.0, 0.08), 10.0),
        filter: unscented(100.0),
        tracker: tracker(150.0, (3, 5), 3),
        gate_m: 1000.0,
    }
}

fn solent() -> Played {
    Played {
        file: "ais-solent/SolentAIS_20160112_130211.csv",
        words: "the Solent, from 13:10 | 400 of 3 s",
        scans: 400,
        scan_period_s: 3.0,
        start_s: 1_452_604_200.0,
        max_gap_s: 180.0,
        radar: radar((50.77, -1.2), 25_000.0, (15.0, 0.1), 5.0),
        filter: unscented(0.01),
        tracker: tracker(6.0, (3, 4), 4),
        gate_m: 300.0,
    }
}

fn england() -> Played {
    Played {
        file: "opensky-uk/OpenSky_Plane_States.csv",
        words: "traffic over England, from 14:00:40 | 280 of 4 s",
        scans: 280,
        scan_period_s: 4.0,
        start_s: 1_626_098_440.0,
        max_gap_s: 120.0,
        radar: radar((52.25, -1.7), 250_000.0, (70.0, 0.08), 10.0),
        filter: unscented(20.0),
        tracker: tracker(150.0, (3, 5), 3),
        gate_m: 1500.0,
    }
}

/// MOTA, recall and switches of a run with seed 1.
fn judged(played: &Played, truth: &Input, credit: &str) -> (f64, f64, u64) {
    let body = json!({
        "seed": 1,
        "truth": {"source": "dataset", "dataset_id": "truth"},
        "input": {"source": "scenario", "scenario": {
            "scans": played.scans, "scan_period_s": played.scan_period_s, "sensors": [played.radar],
            "targets": {"kind": "recorded", "max_gap_s": played.max_gap_s, "start_s": played.start_s}
        }},
        "associator": {"method": "global_nearest_neighbour"},
        "filter": played.filter,
        "tracker": played.tracker,
        "comparison": {"gate_m": played.gate_m, "credit": credit},
        "metrics": [{"metric": "clear"}]
    });
    let plan = plan(JobKind::Evaluate, &body).unwrap_or_else(|faults| panic!("{faults:?}"));
    let outcome = experiment::run(&plan, vec![Some(truth.clone())], &mut Silent).unwrap();
    let clear = outcome.result.pointer("/metrics/clear/quantities").unwrap();
    let number = |name: &str| clear[name]["value"].as_f64().unwrap();
    (number("mota"), number("recall"), number("idsw") as u64)
}

/// The row of a recording in the page, and MOTA as judged at the time.
fn row(played: &Played) -> Option<(String, f64)> {
    let read = crate::real_files::read(played.file, &[])?;
    let truth = Input {
        dataset: read.dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    };
    let (mota, recall, switches) = judged(played, &truth, "at_the_time");
    let (mota_after, recall_after, _) = judged(played, &truth, "afterwards");
    let row = format!(
        "| {} | {mota:.3} | {recall:.3} | {switches} | {mota_after:.3} | {recall_after:.3} |",
        played.words
    );
    Some((row, mota))
}

fn check(played: &Played, least_mota: f64) {
    let Some((row, mota)) = row(played) else {
        return;
    };
    let page = include_str!("../../docs/recordings.md");
    assert!(mota >= least_mota, "{row}");
    assert!(
        page.contains(&row),
        "docs/recordings.md lacks the row\n{row}"
    );
}

#[test]
fn a_radar_follows_traffic_over_switzerland() {
    check(&switzerland(), 0.86);
}

#[test]
fn a_radar_follows_ships_of_the_solent() {
    check(&solent(), 0.91);
}

#[test]
fn a_radar_follows_traffic_over_england() {
    check(&england(), 0.96);
}
