//! Reading what is pushed: every fault of a scan at once, and its numbers as the log keeps them.

use super::detection::PushedDetection;
use super::entry::{PUSHED_SCAN, PushedScan};
use super::reports::Reports;
use super::scene::Scene;
use crate::experiment::request::draft::parse;
use crate::experiment::request::names::check_names;
use crate::formats::read_instant;
use crate::model::fault::Fault;
use crate::model::scan::mean_time_s;
use crate::registry;
use serde::Deserialize;
use serde_json::Value;

/// Reads a pushed scan, with its places in the plane.
///
/// # Errors
/// All its faults.
pub fn read_scan(value: &Value, scene: &Scene) -> Result<PushedScan, Vec<Fault>> {
    let mut scan = checked_scan(value)?;
    let mut faults = Vec::new();
    let Some(sensor) = scene.sensor_index(&scan.sensor_id) else {
        let detail = format!("the session has no sensor '{}'", scan.sensor_id);
        let fault = Fault::new("/sensor_id", "unknown_value", detail);
        return Err(vec![fault.allowing(scene.sensor_ids().join(", "))]);
    };
    check_counts(&scan, scene, &mut faults);
    faults.extend(read_pose(&mut scan, sensor, scene).err());
    let reports = scene.reports(sensor);
    for (index, detection) in scan.detections.iter_mut().enumerate() {
        let fault = detection.put_in_plane(scene.frame()).err();
        let fault = fault.or_else(|| misfit(&scan.sensor_id, reports, detection));
        let found = fault.into_iter().collect();
        faults.extend(registry::placed(&format!("/detections/{index}"), found));
    }
    faults.extend(repeated_ids(&scan));
    if scene.needs_amplitudes() && !scan.detections.iter().all(PushedDetection::has_amplitude) {
        let detail = "the associator needs the amplitude of every detection";
        faults.push(Fault::new("/detections", "missing", detail).allowing("amplitude"));
    }
    faults.extend(settle_times(&mut scan).err());
    if faults.is_empty() && scene.is_relative(sensor) {
        turn_bearings(&mut scan);
    }
    if faults.is_empty() {
        Ok(scan)
    } else {
        Err(faults)
    }
}

/// Checks a pushed scan as far as that goes without its session.
///
/// # Errors
/// All its faults.
pub fn checked_scan(value: &Value) -> Result<PushedScan, Vec<Fault>> {
    let mut faults = Vec::new();
    let checked = registry::check_into(value, &PUSHED_SCAN, &mut faults);
    check_names(&checked, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let mut scan: PushedScan = parse(&checked);
    scan.time_s = read_time(parse(&checked)).map_err(|fault| vec![fault])?;
    Ok(scan)
}

#[derive(Deserialize)]
struct GivenTime {
    time_s: Option<f64>,
    time: Option<String>,
}

/// The time in seconds, also of a text.
fn read_time(given: GivenTime) -> Result<f64, Fault> {
    match (given.time_s, given.time) {
        (Some(time_s), None) => Ok(time_s),
        (None, Some(text)) => read_instant(&text).ok_or_else(|| {
            let detail = format!("'{text}' is not a time");
            let fault = Fault::new("/time", "malformed", detail);
            fault.allowing("ISO 8601, such as 2026-01-31T12:00:00.25Z")
        }),
        (None, None) => {
            let fault = Fault::new("/time_s", "missing", "the scan has no time");
            Err(fault.allowing("time_s, or time"))
        }
        (Some(_), Some(_)) => {
            let fault = Fault::new("/time", "conflict", "time is given beside time_s");
            Err(fault.allowing("one of the two"))
        }
    }
}

fn check_counts(scan: &PushedScan, scene: &Scene, faults: &mut Vec<Fault>) {
    if scan.heartbeat && !scan.detections.is_empty() {
        let detail = "a heartbeat has no detections";
        faults.push(Fault::new("/detections", "conflict", detail).allowing("no detections"));
    }
    if scan.detections.len() > scene.max_detections() {
        let detail = format!("a scan of {} detections", scan.detections.len());
        let most = format!("at most {} (max_detections)", scene.max_detections());
        faults.push(Fault::new("/detections", "too_large", detail).allowing(most));
    }
}

/// A sensor of bearings alone either stands where its settings say or says at each scan where it is; relative bearings need a heading.
fn read_pose(scan: &mut PushedScan, sensor: usize, scene: &Scene) -> Result<(), Fault> {
    let id = &scan.sensor_id;
    let needed = scene.needs_pose(sensor) && !scan.heartbeat;
    let Some(pose) = &mut scan.pose else {
        let detail = format!("sensor '{id}' moves, and the scan does not say where it is");
        let fault = Fault::new("/pose", "missing", detail);
        return if needed {
            Err(fault.allowing("x_m, y_m; heading_deg where bearings are relative"))
        } else {
            Ok(())
        };
    };
    if scene.refuses_pose(sensor) {
        let detail = format!("sensor '{id}' stands where the session says");
        return Err(Fault::new("/pose", "conflict", detail).allowing("no value"));
    }
    pose.put_in_plane(scene.frame())?;
    if scene.is_relative(sensor) && !pose.has_heading() {
        let detail = format!("the bearings of sensor '{id}' are relative to a heading");
        return Err(Fault::new("/pose/heading_deg", "missing", detail).allowing("a heading (deg)"));
    }
    Ok(())
}

fn turn_bearings(scan: &mut PushedScan) {
    if let Some(attitude) = scan.pose.as_ref().and_then(|pose| pose.pose().attitude) {
        for detection in &mut scan.detections {
            detection.turn(&attitude);
        }
    }
}

fn misfit(sensor_id: &str, reports: Reports, detection: &PushedDetection) -> Option<Fault> {
    let given = detection.given();
    let wanted = reports.fields();
    if given != wanted {
        let given = if given.is_empty() {
            "no measurement".to_owned()
        } else {
            given.join(", ")
        };
        let detail = format!(
            "{given} given; sensor '{sensor_id}' reports {}",
            reports.name()
        );
        return Some(Fault::new("", "conflict", detail).allowing(wanted.join(", ")));
    }
    if detection.has_velocity() && !reports.velocities {
        let detail = format!("sensor '{sensor_id}' reports no velocities");
        let fault = Fault::new("/vx_mps", "conflict", detail);
        return Some(fault.allowing("a sensor with sigma_speed_mps and velocity_span_mps"));
    }
    None
}

/// A number is the name of a detection that has none.
fn repeated_ids(scan: &PushedScan) -> Option<Fault> {
    if scan.detections.iter().all(|one| one.detection_id.is_none()) {
        return None;
    }
    let ids = 0..scan.detections.len();
    let mut ids: Vec<String> = ids.map(|index| scan.detection_id(index)).collect();
    ids.sort_unstable();
    let twice = ids.windows(2).find(|pair| pair[0] == pair[1])?;
    let detail = format!("detection '{}' is in the scan more than once", twice[0]);
    Some(Fault::new("/detections", "duplicate", detail))
}

/// Where detections have times of their own, they are in order of these, and the scan is at their mean.
fn settle_times(scan: &mut PushedScan) -> Result<(), Fault> {
    let times_s: Vec<f64> = scan
        .detections
        .iter()
        .filter_map(PushedDetection::time_s)
        .collect();
    if times_s.is_empty() {
        return Ok(());
    }
    if times_s.len() < scan.detections.len() {
        let detail = format!(
            "{} of {} detections have a time of their own",
            times_s.len(),
            scan.detections.len()
        );
        return Err(Fault::new("/detections", "missing", detail).allowing("all of them, or none"));
    }
    for (index, detection) in scan.detections.iter_mut().enumerate() {
        // Its number stays its name where it comes to another place.
        detection
            .detection_id
            .get_or_insert_with(|| (index + 1).to_string());
    }
    let time_s = |one: &PushedDetection| one.time_s().unwrap_or_default();
    scan.detections
        .sort_by(|one, other| time_s(one).total_cmp(&time_s(other)));
    let times_s: Vec<f64> = scan.detections.iter().map(time_s).collect();
    scan.time_s = mean_time_s(&times_s);
    Ok(())
}
