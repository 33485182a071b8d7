//! Compares the clutter density that the tracker was given with what it left over: a density that is far off misleads
//! every method that weighs detections against it. One that was estimated from the same data says nothing to compare.

use super::track::ResolvedRecording;
use crate::experiment::input::extent::Extent;
use crate::math::stats::quantile;
use crate::model::scan::{Measurement, Recording, Scan};
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::sight::clutter::{ClutterMap, ClutterPlan};
use crate::model::sight::{Sight, Spot};
use crate::model::space::Space;
use crate::model::track::TrackSet;
use serde::Serialize;

/// Beyond this factor, either way, the report warns.
const TOLERATED_FACTOR: f64 = 3.0;
/// Fewer false detections than this, found and expected, say nothing.
const LEAST_COUNT: f64 = 10.0;

/// Steps of bearing and of range with which the measure of a sector is counted.
const STEPS: [usize; 2] = [720, 200];

/// A part of what a sensor watches whose density is known.
struct Region {
    /// For people.
    name: String,
    /// As given.
    density: f64,
    /// m² or degrees.
    measure: f64,
    /// Detections that no output track took.
    left_over: f64,
}

/// What the tracker used of a sensor's clutter, beside what the data say.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = ClutterLine))]
pub struct ClutterLine {
    sensor_id: String,
    /// How the density is known: given, detections (all of a scan over the area that holds them), sectors, map or nearest.
    method: &'static str,
    /// Of the densities: 1/m², 1/m³ or 1/deg.
    unit: &'static str,
    /// The density outside sectors, where a map begins, and where there are too few neighbours.
    used: f64,
    /// Detections outside every output track per scan, over all that the sensor watches.
    left_over: f64,
    /// Of a map at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    map: Option<MapLine>,
}

/// A map of clutter at the end.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = ClutterMapLine))]
struct MapLine {
    cells: u64,
    lowest: f64,
    median: f64,
    highest: f64,
}

/// What was used of each sensor's clutter; `None` where every density was given as one number. `maps` are those at the end.
pub fn lines(
    data: &ResolvedRecording,
    tracks: &TrackSet,
    maps: &[Option<ClutterMap>],
) -> Option<Vec<ClutterLine>> {
    let mut methods = Vec::with_capacity(data.sensors.len());
    for (index, (settings, sensor)) in data.known.iter().zip(data.sensors).enumerate() {
        let extent = Extent::measure(data.recording, index, settings, &sensor.report);
        methods.push((method_of(sensor, settings, &extent), extent));
    }
    // The runs of a campaign have nothing to tell as a rule.
    if methods.iter().all(|(method, _)| *method == "given") {
        return None;
    }
    let used = used_detections(data.recording, tracks);
    let mut found = Vec::with_capacity(data.sensors.len());
    for (index, (sensor, (method, extent))) in data.sensors.iter().zip(methods).enumerate() {
        let scans = data
            .recording
            .scans
            .iter()
            .filter(|scan| scan.sensor == index);
        let left = left_over(data.recording, index, &used).count() as f64;
        let scanned = extent.watched * scans.count() as f64;
        let map = maps.get(index).and_then(Option::as_ref);
        let outside = |density: f64| density / extent.inside(1.0);
        found.push(ClutterLine {
            sensor_id: sensor.sensor_id.clone(),
            method,
            unit: match extent.space {
                Space::Bearing => "1/deg",
                Space::Plane => "1/m²",
                Space::Volume => "1/m³",
            },
            used: outside(sensor.clutter_density),
            left_over: if scanned > 0.0 { left / scanned } else { 0.0 },
            map: map.map(|map| map_line(map, outside(sensor.clutter_density))),
        });
    }
    Some(found)
}

/// How the density of a sensor is known.
fn method_of(sensor: &Sensor, settings: &SensorSettings, extent: &Extent) -> &'static str {
    let plan = sensor
        .sight
        .as_ref()
        .and_then(|sight| sight.clutter.as_ref());
    match plan {
        Some(ClutterPlan::Map(_)) => "map",
        Some(ClutterPlan::Nearest { .. }) => "nearest",
        None if has_sectors(sensor) => "sectors",
        None if extent.density_of(settings).is_none() => "detections",
        None => "given",
    }
}

fn map_line(map: &ClutterMap, density: f64) -> MapLine {
    let mut densities: Vec<f64> = map.ratios().iter().map(|ratio| ratio * density).collect();
    densities.sort_by(f64::total_cmp);
    let at = |share: f64| quantile(&densities, share).unwrap_or(density);
    MapLine {
        cells: densities.len() as u64,
        lowest: at(0.0),
        median: at(0.5),
        highest: at(1.0),
    }
}

fn has_sectors(sensor: &Sensor) -> bool {
    let sight = sensor.sight.as_ref();
    sight.is_some_and(|sight| sight.has_clutter_sectors() && sight.clutter.is_none())
}

/// A warning for each sensor, and each sector of one, whose given density disagrees with the detections that no output track
/// was given.
pub fn disagreements(data: &ResolvedRecording, tracks: &TrackSet) -> Vec<String> {
    let used = used_detections(data.recording, tracks);
    let mut warnings = Vec::new();
    for (index, settings) in data.known.iter().enumerate() {
        let sensor = &data.sensors[index];
        // What is learnt from the data agrees with them.
        if sensor
            .sight
            .as_ref()
            .is_some_and(|sight| sight.clutter.is_some())
        {
            continue;
        }
        let extent = Extent::measure(data.recording, index, settings, &sensor.report);
        let scans = data
            .recording
            .scans
            .iter()
            .filter(|scan| scan.sensor == index);
        let scans = scans.count();
        for region in regions(data, index, &extent, &used) {
            warnings.extend(disagreement(&region, scans, extent.unit()));
        }
    }
    warnings
}

fn disagreement(region: &Region, scans: usize, unit: &str) -> Option<String> {
    let Region {
        name,
        density,
        measure,
        left_over,
    } = region;
    let scanned = measure * scans as f64;
    let expected = density * scanned;
    let is_off =
        *left_over > TOLERATED_FACTOR * expected || expected > TOLERATED_FACTOR * left_over;
    (is_off && left_over.max(expected) >= LEAST_COUNT && scanned > 0.0).then(|| {
        format!(
            "{name}: the clutter density {density:.3e} per {unit} disagrees with the data by more than a factor of {TOLERATED_FACTOR}: \
             {left_over} detections outside every output track in {scans} scans of {measure:.3e} {unit} are {:.3e} per {unit}",
            left_over / scanned
        )
    })
}

/// The parts of what a sensor watches whose densities were given: sectors with one of their own, and the rest.
fn regions(data: &ResolvedRecording, index: usize, extent: &Extent, used: &[bool]) -> Vec<Region> {
    let (settings, sensor) = (&data.known[index], &data.sensors[index]);
    let name = format!("sensor '{}'", sensor.sensor_id);
    let Some(sight) = sensor.sight.as_ref().filter(|_| has_sectors(sensor)) else {
        let region = |density| Region {
            name,
            density,
            measure: extent.watched,
            left_over: left_over(data.recording, index, used).count() as f64,
        };
        return extent
            .density_of(settings)
            .map(region)
            .into_iter()
            .collect();
    };
    let used_density = sensor.clutter_density / extent.inside(1.0);
    let mut regions = vec![Region {
        name: name.clone(),
        density: used_density,
        measure: 0.0,
        left_over: 0.0,
    }];
    for (nth, sector) in sight.sectors.iter().enumerate() {
        regions.push(Region {
            name: format!("{name}, sector {nth}"),
            density: used_density * sector.log_clutter_ratio.exp(),
            measure: 0.0,
            left_over: 0.0,
        });
    }
    for (spot, measure) in parts(sight, extent) {
        regions[region_of(sight, &spot)].measure += measure;
    }
    for spot in left_over(data.recording, index, used)
        .map(|(scan, report)| Spot::of_report(report, &sight.place_in(scan)))
    {
        regions[region_of(sight, &spot)].left_over += 1.0;
    }
    if extent.density_of(settings).is_none() {
        regions.remove(0);
    }
    regions
}

/// 0 outside sectors with a density of their own, else one more than the sector's index.
fn region_of(sight: &Sight, spot: &Spot) -> usize {
    let sector = sight
        .sectors
        .iter()
        .position(|sector| sector.limits.hold(spot));
    sector
        .filter(|&index| sight.sectors[index].log_clutter_ratio != 0.0)
        .map_or(0, |index| index + 1)
}

/// Small parts of what a sensor watches, by their middles and measures. A sensor without a greatest range watches as much as
/// was seen, taken as a disc.
fn parts(sight: &Sight, extent: &Extent) -> Vec<(Spot, f64)> {
    let (from_rad, width_rad) = sight.view.arc_rad();
    let is_arc = extent.unit() == "degree";
    let [turns, rings] = if is_arc { [36_000, 1] } else { STEPS };
    let near_m = sight.view.range_from_m();
    let far_m = (near_m * near_m + 2.0 * extent.watched / width_rad).sqrt();
    let mut parts = Vec::with_capacity(turns * rings);
    for turn in 0..turns {
        let bearing_rad = from_rad + width_rad * (turn as f64 + 0.5) / turns as f64;
        for ring in 0..rings {
            // Rings of equal area.
            let share = (ring as f64 + 0.5) / rings as f64;
            let range_m = (near_m * near_m + share * (far_m * far_m - near_m * near_m)).sqrt();
            let spot = Spot {
                bearing_rad,
                range_m: (!is_arc).then_some(range_m),
            };
            parts.push((spot, extent.watched / (turns * rings) as f64));
        }
    }
    parts
}

/// The detections of a sensor that no output track took, with their scans.
fn left_over<'a>(
    recording: &'a Recording,
    sensor: usize,
    used: &'a [bool],
) -> impl Iterator<Item = (&'a Scan, &'a Measurement)> {
    let scans = recording.scans_with_firsts();
    let of_sensor = scans.filter(move |(_, scan)| scan.sensor == sensor);
    of_sensor.flat_map(move |(first, scan)| {
        let detections = scan.detections.iter().enumerate();
        detections
            .filter(move |(index, _)| !used[first + index])
            .map(move |(_, detection)| (scan, &detection.measurement))
    })
}

/// For each detection of the recording, whether an output track more likely took it than not.
fn used_detections(recording: &Recording, tracks: &TrackSet) -> Vec<bool> {
    let mut used = vec![false; recording.detection_count()];
    let points = tracks.tracks.iter().flat_map(|track| &track.points);
    for candidate in points
        .flat_map(|point| tracks.candidates_of(point))
        .filter(|candidate| candidate.probability > 0.5)
    {
        if let Some(detection) = candidate.detection {
            used[detection as usize] = true;
        }
    }
    used
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::input::tests::one_scan;
    use crate::model::scan::Measurement;
    use crate::model::sensing::MeasurementModel;
    use crate::model::sensor::{Sensor, SensorSettings};
    use crate::model::sight::{Limits, Sector, SectorSettings};
    use crate::model::state::Position;

    /// One scan of a sensor with a field of view of 1 000 m², and `count` detections that no track takes.
    fn warnings(count: usize, clutter_per_m2: Option<f64>) -> Vec<String> {
        let max_range_m = Some((1000.0 / std::f64::consts::PI).sqrt());
        let settings = SensorSettings {
            max_range_m,
            clutter_per_m2,
            ..SensorSettings::named("radar")
        };
        let place = |index: usize| Measurement::Position {
            x_m: index as f64,
            y_m: 0.0,
        };
        let places: Vec<Measurement> = (0..count).map(place).collect();
        let recording = one_scan(settings.clone(), &places);
        let report = MeasurementModel::Position {
            sigma_x_m: 1.0,
            sigma_y_m: 1.0,
        };
        let sensor = Sensor {
            sensor_id: "radar".into(),
            p_d: 0.9,
            clutter_density: clutter_per_m2.unwrap_or(1e3),
            may_start: true,
            report,
            sight: None,
        };
        let data = ResolvedRecording {
            recording: &recording,
            known: &[settings],
            sensors: &[sensor],
        };
        disagreements(&data, &TrackSet::default())
    }

    #[test]
    fn a_density_within_a_factor_of_three_is_not_mentioned() {
        assert_eq!(warnings(20, Some(0.02)), Vec::<String>::new());
        assert_eq!(warnings(59, Some(0.02)), Vec::<String>::new());
        assert_eq!(
            warnings(9, Some(1e-6)),
            Vec::<String>::new(),
            "nine detections are too few to tell"
        );
    }

    #[test]
    fn one_that_was_estimated_is_not_compared() {
        assert_eq!(warnings(61, None), Vec::<String>::new());
    }

    #[test]
    fn one_that_is_further_off_is_named_with_the_estimate() {
        let high = warnings(61, Some(0.02));
        assert!(
            high.len() == 1 && high[0].contains("6.100e-2 per m²"),
            "{high:?}"
        );
        let low = warnings(6, Some(0.02));
        assert!(
            low.len() == 1 && low[0].contains("6.000e-3 per m²"),
            "{low:?}"
        );
    }

    #[test]
    fn each_sector_is_held_against_what_lies_in_it() {
        // A disc of 1 000 m² whose eastern quarter is said to have 0.02 and the rest 1e-9 per m². Sixty detections in the west.
        let east = SectorSettings {
            bearing_from_deg: Some(45.0),
            bearing_to_deg: Some(135.0),
            clutter_per_m2: Some(0.02),
            ..SectorSettings::default()
        };
        let settings = SensorSettings {
            x_m: Some(0.0),
            y_m: Some(0.0),
            max_range_m: Some((1000.0 / std::f64::consts::PI).sqrt()),
            clutter_per_m2: Some(0.08),
            sectors: Some(vec![east]),
            ..SensorSettings::named("radar")
        };
        let place = |index: usize| Measurement::Position {
            x_m: -1.0 - 0.1 * index as f64,
            y_m: 0.0,
        };
        let places: Vec<Measurement> = (0..60).map(place).collect();
        let recording = one_scan(settings.clone(), &places);
        let sensor = Sensor {
            clutter_density: 0.08,
            sight: Some(Sight {
                place_m: Position::zeros(),
                view: Limits::ALL,
                sectors: vec![Sector {
                    limits: east.view().limits(),
                    p_d: None,
                    log_clutter_ratio: 0.25f64.ln(),
                }],
                p_d: 0.9,
                by_range: None,
                clutter: None,
            }),
            ..Sensor::of_positions(&settings, 1.0)
        };
        let data = ResolvedRecording {
            recording: &recording,
            known: &[settings],
            sensors: &[sensor],
        };
        // 0.08 × 750 m² = 60 agree; none of 0.02 × 250 m² = 5 is too few to tell.
        assert_eq!(
            disagreements(&data, &TrackSet::default()),
            Vec::<String>::new()
        );
        let lines = lines(&data, &TrackSet::default(), &[]).unwrap();
        assert_eq!((lines[0].method, lines[0].used), ("sectors", 0.08));
        assert!((lines[0].left_over - 0.06).abs() < 1e-12);
    }
}
