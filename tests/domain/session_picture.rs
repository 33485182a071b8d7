//! The picture of a session: places of detections, numbers of scans, and what is no longer kept.

use crate::sessions::{push, scene};
use serde_json::{Value, json};
use std::sync::Arc;
use trackloom_domain::experiment::session::{EntryFate, Scene, Session};

fn plots(time_s: f64, places_m: &[[f64; 2]]) -> Value {
    let detections: Vec<Value> = places_m
        .iter()
        .map(|[x_m, y_m]| json!({"x_m": x_m, "y_m": y_m}))
        .collect();
    json!({"sensor_id": "plots", "time_s": time_s, "detections": detections})
}

fn numbers(session: &Session, after: Option<u64>) -> Vec<u64> {
    let picture = session.picture(after);
    picture.scans.iter().map(|scan| scan.number).collect()
}

#[test]
fn detections_are_places_in_the_plane_and_bearings_directions_from_their_sensor() {
    let mut session = Session::new(scene(json!({})));
    push(&mut session, &plots(1.0, &[[10.0, 20.0], [30.0, -40.0]]));
    let radar = json!({"sensor_id": "radar", "time_s": 2.0, "detections": [{"range_m": 1000.0, "bearing_deg": 90.0}]});
    push(&mut session, &radar);
    let picture = session.picture(None);
    let plots = &picture.scans[0];
    assert_eq!((plots.number, plots.sensor_id.as_str()), (1, "plots"));
    assert_eq!(
        (&plots.x_m[..], &plots.y_m[..]),
        (&[10.0, 30.0][..], &[20.0, -40.0][..])
    );
    assert_eq!(plots.sensor_x_m, None);
    let radar = &picture.scans[1];
    assert_eq!((radar.number, radar.time_s, radar.detections), (2, 2.0, 1));
    assert!((radar.x_m[0] - 1500.0).abs() < 1e-9 && (radar.y_m[0] + 800.0).abs() < 1e-9);
    assert_eq!(
        (radar.sensor_x_m, radar.sensor_y_m),
        (Some(500.0), Some(-800.0))
    );
    let places: Vec<_> = picture
        .sensors
        .iter()
        .map(|sensor| sensor.x_m.zip(sensor.y_m))
        .collect();
    assert_eq!(places, [None, Some((500.0, -800.0))]);
    assert_eq!(
        (picture.last_scan, picture.processed_to_s, picture.lag_s),
        (2, Some(2.0), Some(0.0))
    );
    assert_eq!((picture.counts.scans, picture.counts.detections), (2, 3));
    assert_eq!(picture.tracks, session.tracks(None));
    assert_eq!(numbers(&session, Some(1)), [2]);
    assert_eq!(numbers(&session, Some(2)), [0; 0]);

    let sonar = json!({
        "sensors": [{"sensor_id": "sonar", "x_m": 3.0, "y_m": 4.0, "sigma_bearing_deg": 1.0, "p_d": 0.9, "clutter_per_deg": 1e-3}]
    });
    let mut session = Session::new(Arc::new(Scene::plan(&sonar).unwrap()));
    for index in 0..4 {
        let bearing_deg = 200.0 + f64::from(index);
        let scan = json!({"sensor_id": "sonar", "time_s": f64::from(index), "detections": [{"bearing_deg": bearing_deg}]});
        push(&mut session, &scan);
    }
    let picture = session.picture(Some(3));
    assert_eq!(picture.scans.len(), 1);
    assert!(
        (picture.scans[0].bearing_deg[0] - 203.0).abs() < 1e-9 && picture.scans[0].x_m.is_empty()
    );
    assert_eq!(
        (picture.scans[0].sensor_x_m, picture.scans[0].sensor_y_m),
        (Some(3.0), Some(4.0))
    );
}

#[test]
fn ways_lead_to_where_the_tracks_are_and_come_only_with_a_first_picture() {
    let mut session = Session::new(scene(json!({})));
    for index in 0..100 {
        let time_s = f64::from(index);
        push(&mut session, &plots(time_s, &[[10.0 * time_s, 500.0]]));
    }
    let picture = session.picture(None);
    let ways = picture.ways.unwrap();
    assert_eq!((ways.len(), picture.tracks.len()), (1, 1));
    let (way, track) = (&ways[0], &picture.tracks[0]);
    assert_eq!(
        (way.track_id.as_str(), way.time_s.len()),
        (track.track_id.as_str(), 64)
    );
    assert_eq!((way.time_s[0], way.time_s[63]), (36.0, 99.0));
    assert_eq!(
        (Some(way.x_m[63]), Some(way.y_m[63])),
        (track.point.x_m, track.point.y_m)
    );
    assert!((way.x_m[0] - 360.0).abs() < 20.0 && (way.y_m[0] - 500.0).abs() < 20.0);
    assert_eq!(session.picture(Some(0)).ways, None);
}

#[test]
fn the_latest_scans_are_kept_and_of_many_detections_fewer() {
    let mut session = Session::new(scene(json!({})));
    for index in 0..70 {
        push(&mut session, &plots(f64::from(index), &[]));
    }
    let kept = numbers(&session, None);
    assert_eq!((kept.len(), kept[0], kept[63]), (64, 7, 70));
    // Tracks are not what is counted here.
    let mut session = Session::new(scene(json!({"max_tracks": 1})));
    let many: Vec<[f64; 2]> = (0..400)
        .map(|index| [f64::from(index) * 5e3, 0.0])
        .collect();
    for index in 0..60 {
        push(&mut session, &plots(f64::from(index), &many));
    }
    let kept = numbers(&session, None);
    assert_eq!((kept.len(), kept[0], kept[49]), (50, 11, 60));
}

#[test]
fn a_scan_is_told_once_when_the_tracker_takes_it_first() {
    let mut waiting = Session::new(scene(json!({"late": "wait", "delay_s": 5.0})));
    push(&mut waiting, &plots(10.0, &[]));
    push(&mut waiting, &plots(12.0, &[]));
    let picture = waiting.picture(None);
    assert_eq!(
        (picture.last_scan, picture.waiting, picture.lag_s),
        (0, 2, None)
    );
    push(&mut waiting, &plots(16.0, &[]));
    let picture = waiting.picture(None);
    assert_eq!(
        (picture.last_scan, picture.waiting, picture.lag_s),
        (1, 2, Some(6.0))
    );
    assert_eq!(picture.scans[0].time_s, 10.0);

    let replay = json!({"late": "replay", "window_s": 60.0});
    let mut session = Session::new(scene(replay.clone()));
    for time_s in [1.0, 2.0, 3.0, 5.0] {
        push(&mut session, &plots(time_s, &[[time_s, 0.0]]));
    }
    assert_eq!(
        push(&mut session, &plots(4.0, &[[4.0, 0.0]])),
        EntryFate::Replayed
    );
    let picture = session.picture(Some(4));
    assert_eq!((picture.last_scan, picture.scans.len()), (5, 1));
    assert_eq!(
        (picture.scans[0].time_s, &picture.scans[0].x_m[..]),
        (4.0, &[4.0][..])
    );

    // Who reads it back knows how many there were, and none of them.
    let written = session.write_down();
    let mut again = Session::read_back(scene(replay), &written).unwrap();
    assert_eq!((again.last_scan(), numbers(&again, None)), (5, vec![]));
    push(&mut again, &plots(6.0, &[]));
    assert_eq!(numbers(&again, Some(5)), [6]);
}
