//! What a sensor sees, from what is known of it; and whether its detections lie there.

use super::place;
use crate::experiment::input::extent::{Extent, corners, detections_of, place_of};
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording};
use crate::model::sensing::MeasurementModel;
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::sight::clutter::{ClutterPlan, ClutterSettings, MapArea, MapPlan};
use crate::model::sight::{RangeLaw, Sector, SectorSettings, Sight, Spot, ViewSettings};
use crate::model::space::Space;

/// Assumed where a radar's P_D is stated for a range and nobody says how often it is wrong.
const ASSUMED_P_FA: f64 = 1e-6;

/// The sensor with what is known of where it sees.
///
/// # Errors
/// Limits, probabilities or densities that do not fit together.
pub(super) fn with_sight(
    sensor: Sensor,
    (recording, index): (&Recording, usize),
    settings: &SensorSettings,
    extent: &Extent,
    warnings: &mut Vec<String>,
) -> Result<Sensor, Vec<Fault>> {
    let faults = faults_of(settings, &sensor, extent);
    if !faults.is_empty() {
        return Err(faults);
    }
    let clutter = plan_of(settings, &sensor, (recording, index));
    if settings.field_of_view.is_none()
        && settings.sectors.is_none()
        && settings.p_d_at_m.is_none()
        && clutter.is_none()
    {
        return Ok(sensor);
    }
    let stands = recording
        .scans
        .iter()
        .any(|scan| scan.sensor == index && scan.pose.is_none());
    let place_m = if stands && sensor.report.place_m().is_none() {
        place(settings, warnings)
    } else {
        place_of(settings)
    };
    let density = sensor.clutter_density;
    let sector = |sector: &SectorSettings| Sector {
        limits: sector.view().limits(),
        p_d: sector.p_d,
        log_clutter_ratio: density_of(sector, extent.space)
            .map_or(0.0, |here| (extent.inside(here) / density).ln()),
    };
    let sight = Sight {
        place_m,
        view: settings.field_of_view.unwrap_or_default().limits(),
        sectors: settings.sectors.iter().flatten().map(sector).collect(),
        p_d: sensor.p_d,
        by_range: settings
            .p_d_at_m
            .map(|at_m| RangeLaw::new(sensor.p_d, at_m, settings.p_fa.unwrap_or(ASSUMED_P_FA))),
        clutter,
    };
    warnings.extend(outside(&sight, &sensor, recording, index));
    Ok(Sensor {
        sight: Some(sight),
        ..sensor
    })
}

fn density_of(sector: &SectorSettings, space: Space) -> Option<f64> {
    match space {
        Space::Bearing => sector.clutter_per_deg,
        Space::Plane => sector.clutter_per_m2,
        Space::Volume => None,
    }
}

/// How clutter is learnt. There is no map of a sensor whose detections cover nothing.
fn plan_of(
    settings: &SensorSettings,
    sensor: &Sensor,
    (recording, index): (&Recording, usize),
) -> Option<ClutterPlan> {
    let (alpha, cells) = match settings.clutter? {
        ClutterSettings::Estimated => return None,
        ClutterSettings::Nearest { k } => return Some(ClutterPlan::Nearest { k: k as usize }),
        ClutterSettings::Map { alpha, cells } => (alpha, cells as usize),
    };
    let view = settings.field_of_view.unwrap_or_default();
    let area = match sensor.report {
        MeasurementModel::Bearing(_) | MeasurementModel::Sight(_) => MapArea::Arc(view.limits()),
        MeasurementModel::Polar(_)
        | MeasurementModel::Converted(_)
        | MeasurementModel::Spherical(_)
        | MeasurementModel::ConvertedSpherical(_) => {
            let farthest_m = || farthest_m(recording, index);
            let range_to_m = view.range_to_m.or(settings.max_range_m);
            let limits = ViewSettings {
                range_to_m: Some(range_to_m.unwrap_or_else(farthest_m)),
                ..view
            };
            MapArea::Polar(limits.limits())
        }
        MeasurementModel::Position { .. }
        | MeasurementModel::Position3 { .. }
        | MeasurementModel::Moving(_) => {
            let (low_m, high_m) = corners(recording, index, settings)?;
            MapArea::Plane { low_m, high_m }
        }
    };
    let plan = MapPlan {
        alpha,
        area,
        cells: [cells; 2],
    };
    let is_flat = (0..plan.cell_count()).any(|cell| plan.measure_of(cell) <= 0.0);
    (!is_flat).then_some(ClutterPlan::Map(plan))
}

fn farthest_m(recording: &Recording, index: usize) -> f64 {
    let range_m = |detection: &Detection| match detection.measurement.flat() {
        Measurement::RangeBearing { range_m, .. } => range_m,
        _ => 0.0,
    };
    detections_of(recording, index)
        .map(range_m)
        .fold(0.0, f64::max)
}

/// How the clutter of what tells heights is stated where parts of the ground differ.
const GROUND: &str = "clutter_per_m2 of the sensor";

/// What no table can see.
fn faults_of(settings: &SensorSettings, sensor: &Sensor, extent: &Extent) -> Vec<Fault> {
    let mut faults = Vec::new();
    let name = &settings.sensor_id;
    let mut refuse = |code: &str, detail: String, allowed: &str| {
        faults.push(Fault::new("/sensors", code, detail).allowing(allowed));
    };
    const LIMITS: &str = "both bearings or neither; range_from_m below range_to_m";
    if settings.field_of_view.is_some_and(|view| !view.is_sound()) {
        let detail = format!("the field of view of sensor '{name}' is no part of a plane");
        refuse("conflict", detail, LIMITS);
    }
    for (index, sector) in settings.sectors.iter().flatten().enumerate() {
        if !sector.is_sound() {
            let detail = format!("sector {index} of sensor '{name}' is no part of a plane");
            refuse("conflict", detail, LIMITS);
        }
        let stated = sector.clutter_per_m2.or(sector.clutter_per_deg);
        if stated.is_some() && density_of(sector, extent.space).is_none() {
            let (given, wanted) = match extent.space {
                Space::Bearing => ("clutter_per_m2", "clutter_per_deg"),
                Space::Plane => ("clutter_per_deg", "clutter_per_m2"),
                Space::Volume => ("clutter_per_m2", GROUND),
            };
            let detail = format!(
                "the clutter of sector {index} of sensor '{name}' is stated in '{given}'; what is used of its reports needs '{wanted}'"
            );
            refuse("unsupported", detail, wanted);
        }
    }
    let is_learnt = settings
        .clutter
        .is_some_and(|clutter| clutter != ClutterSettings::Estimated);
    if is_learnt && extent.space == Space::Volume {
        let detail = format!(
            "clutter is learnt per square metre, and that of sensor '{name}' is not stated so"
        );
        refuse("unsupported", detail, GROUND);
    }
    if settings.clutter.is_some_and(|clutter| !clutter.is_sound()) {
        let detail = format!("the clutter of sensor '{name}' cannot be learnt so");
        refuse(
            "out_of_range",
            detail,
            "alpha in (0, 1), 1 to 100 cells, k from 2 to 50",
        );
    }
    let p_fa = settings.p_fa.unwrap_or(ASSUMED_P_FA);
    if settings.p_d_at_m.is_some() && !(p_fa < sensor.p_d && sensor.p_d < 1.0) {
        let detail = format!(
            "a radar's P_D at a range lies between its P_FA {p_fa} and 1; that of sensor '{name}' is {}",
            sensor.p_d
        );
        refuse("conflict", detail, "p_fa < p_d < 1");
    }
    faults
}

/// A warning where a sensor reports what it cannot see.
fn outside(sight: &Sight, sensor: &Sensor, recording: &Recording, index: usize) -> Option<String> {
    let (mut outside, mut all) = (0u64, 0u64);
    for scan in recording.scans.iter().filter(|scan| scan.sensor == index) {
        let from_m = sight.place_in(scan);
        for detection in &scan.detections {
            let spot = Spot::of_report(&detection.measurement, &from_m);
            outside += u64::from(!sight.view.hold(&spot));
            all += 1;
        }
    }
    (outside > 0).then(|| {
        format!(
            "sensor '{}': {outside} of {all} detections lie outside its field of view, where no track can be given them",
            sensor.sensor_id
        )
    })
}
