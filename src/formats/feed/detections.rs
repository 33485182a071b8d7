//! Reports as detections: gathered in scans, each with its own time, height and codes kept beside it.

use super::place::Ground;
use super::scans;
use super::{Attribute, Feed, Manner, Spot};
use crate::formats::Reading;
use crate::model::beside::{Beside, Labels};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::own::{Own, OwnNoise, whole};
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan, mean_time_s};
use crate::model::sensor::SensorSettings;
use crate::model::state::Position;
use std::collections::{BTreeMap, HashSet};

/// Period of the scans that reports without scans are gathered in (s).
pub(in crate::formats) const FRAME_S: f64 = 10.0;
/// Noise of a radar's plots that do not say theirs (m, degrees).
const RADAR_SIGMAS: (f64, f64) = (70.0, 0.08);

pub(super) fn build(
    feed: &mut Feed,
    is_wild: &[bool],
    manner: &Manner,
    reading: &Reading,
) -> Result<Dataset, Vec<Fault>> {
    let mut order: Vec<usize> = (0..feed.reports.len())
        .filter(|&index| !is_wild[index])
        .collect();
    order.sort_by(|&a, &b| feed.reports[a].time_s.total_cmp(&feed.reports[b].time_s));
    let scans = scans::divide(feed, &order, reading.frame_s.unwrap_or(FRAME_S));
    let order = drop_superseded(feed, order, &scans);
    let mut ground = Ground::of(feed, &order, reading)?;
    let sensors = sensors_of(feed, &ground, manner);
    let mut parts = RecordingParts {
        frame: ground.frame,
        sensors,
        ..RecordingParts::default()
    };
    let (names, numbers) = std::mem::take(&mut feed.identities).sorted();
    let has_identities = order
        .iter()
        .any(|&index| feed.reports[index].identity.is_some());
    if has_identities {
        (parts.targets, parts.origins_known) = (names, true);
    }
    fill_scans(feed, &order, (&scans, &numbers), (&mut ground, &mut parts));
    feed.warnings.extend(ground.warning());
    for &index in &order {
        feed.units.use_up(u64::from(feed.reports[index].units));
    }
    Ok(Dataset::Detections(Recording::new(parts)?))
}

/// Of an identity's reports in one scan the last is kept.
fn drop_superseded(feed: &mut Feed, order: Vec<usize>, scans: &[i64]) -> Vec<usize> {
    let mut seen = HashSet::new();
    let mut kept = Vec::with_capacity(order.len());
    for &index in order.iter().rev() {
        let report = &feed.reports[index];
        let key = (report.sensor, scans[index], report.identity);
        if report.identity.is_none() || seen.insert(key) {
            kept.push(index);
        } else {
            feed.units.ignore("superseded", u64::from(report.units));
        }
    }
    kept.reverse();
    kept
}

fn sensors_of(feed: &mut Feed, ground: &Ground, manner: &Manner) -> Vec<SensorSettings> {
    let names = std::mem::take(&mut feed.sensors).into_names();
    let mut polar = vec![false; names.len()];
    let mut moves = vec![false; names.len()];
    let mut sigmas_m: Vec<Option<f64>> = vec![None; names.len()];
    for report in &feed.reports {
        let sensor = report.sensor as usize;
        polar[sensor] |= matches!(report.spot, Spot::Polar { .. });
        moves[sensor] |= report.motion.is_some();
        // The noise of a sensor is that of its worst report.
        let sigma_m = report.sigma_m.unwrap_or(manner.sigma_m);
        sigmas_m[sensor] = Some(sigmas_m[sensor].map_or(sigma_m, |known| known.max(sigma_m)));
    }
    let mut unplaced = Vec::new();
    let mut sensors = Vec::with_capacity(names.len());
    for (sensor, name) in names.into_iter().enumerate() {
        let mut settings = SensorSettings::named(name);
        let number = sensor as u32;
        if let Some(site) = ground.site(number) {
            (settings.lat_deg, settings.lon_deg) = (Some(site.lat_deg), Some(site.lon_deg));
            settings.height_m = Some(site.height_m);
        } else if polar[sensor] {
            unplaced.push(settings.sensor_id.clone());
        }
        let place_m: Option<Position> = ground.site_m(number);
        (settings.x_m, settings.y_m) = (place_m.map(|place| place.x), place_m.map(|place| place.y));
        if polar[sensor] {
            settings.sigma_range_m = Some(RADAR_SIGMAS.0);
            settings.sigma_bearing_deg = Some(RADAR_SIGMAS.1);
        } else {
            (settings.sigma_x_m, settings.sigma_y_m) = (sigmas_m[sensor], sigmas_m[sensor]);
            settings.sigma_speed_mps = moves[sensor].then_some(manner.sigma_speed_mps);
            settings.sigma_course_deg = manner.sigma_course_deg.filter(|_| moves[sensor]);
        }
        sensors.push(settings);
    }
    if !unplaced.is_empty() {
        feed.warnings.push(format!(
            "nobody says where these radars stand: {}; `sites` does",
            unplaced.join(", ")
        ));
    }
    sensors
}

fn fill_scans(
    feed: &Feed,
    order: &[usize],
    (scans, numbers): (&[i64], &[u32]),
    (ground, parts): (&mut Ground, &mut RecordingParts),
) {
    let mut of_scan: BTreeMap<(u32, i64), Vec<usize>> = BTreeMap::new();
    for &index in order {
        let key = (feed.reports[index].sensor, scans[index]);
        of_scan.entry(key).or_default().push(index);
    }
    let mut keys: Vec<(f64, (u32, i64))> = Vec::with_capacity(of_scan.len());
    for (key, of_it) in &of_scan {
        let times_s: Vec<f64> = of_it
            .iter()
            .map(|&index| feed.reports[index].time_s)
            .collect();
        keys.push((mean_time_s(&times_s), *key));
    }
    keys.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut counted: BTreeMap<u32, u32> = BTreeMap::new();
    let mut labels = LabelMaker::default();
    for (time_s, key) in keys {
        let number = counted.entry(key.0).or_default();
        *number += 1;
        let mut scan = Scan {
            number: *number,
            time_s,
            sensor: key.0 as usize,
            pose: None,
            own: Vec::new(),
            detections: Vec::new(),
        };
        for &index in &of_scan[&key] {
            let report = &feed.reports[index];
            let Some(measurement) = measure(report, ground) else {
                continue;
            };
            scan.own.push(own_of(report, time_s, ground));
            scan.detections.push(Detection {
                measurement,
                origin: report.identity.map(|identity| numbers[identity as usize]),
                amplitude: None,
            });
            parts.detection_ids.push(report.unit.to_string());
            parts.beside.times_s.push(report.time_s);
            parts.beside.heights_m.push(report.height_m);
            labels.note(parts.beside.times_s.len(), feed, index);
        }
        scan.own = whole(scan.own);
        parts.scans.push(scan);
    }
    labels.finish(&mut parts.beside);
}

/// Its time in the scan, how well its place is known, and its velocity, as far as it says them.
fn own_of(report: &super::Report, scan_s: f64, ground: &Ground) -> Own {
    let is_placed = !matches!(report.spot, super::Spot::Polar { .. });
    let sigma_m = report.sigma_m.filter(|sigma_m| *sigma_m > 0.0 && is_placed);
    let velocity_mps = is_placed.then(|| ground.velocity(report)).flatten();
    Own {
        after_s: report.time_s - scan_s,
        noise: OwnNoise {
            sigma_x_m: sigma_m,
            sigma_y_m: sigma_m,
            ..OwnNoise::default()
        },
        velocity_mps: velocity_mps.map(|velocity_mps| [velocity_mps.x, velocity_mps.y]),
    }
}

pub(in crate::formats) fn measure(
    report: &super::Report,
    ground: &mut Ground,
) -> Option<Measurement> {
    if let Some((range_m, bearing_rad)) = ground.polar(report) {
        return Some(Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps: None,
        });
    }
    let place_m = ground.place_m(report)?;
    Some(Measurement::Position {
        x_m: place_m.x,
        y_m: place_m.y,
    })
}

/// Numbers the texts of each attribute.
#[derive(Default)]
struct LabelMaker {
    /// With them, by the number of a text in the feed: its number among the attribute's labels.
    of: BTreeMap<Attribute, (Labels, Vec<Option<u32>>)>,
}

impl LabelMaker {
    /// Keeps what is said of the last of so many detections.
    fn note(&mut self, detections: usize, feed: &Feed, report: usize) {
        for (attribute, text) in feed.numbers_said_of(report) {
            let (labels, numbers) = self.of.entry(attribute).or_default();
            if numbers.len() <= text as usize {
                numbers.resize(text as usize + 1, None);
            }
            let number = *numbers[text as usize].get_or_insert_with(|| {
                labels.texts.push(feed.texts.name(text).to_owned());
                labels.texts.len() as u32 - 1
            });
            labels.of.resize(detections, None);
            if let Some(last) = labels.of.last_mut() {
                *last = Some(number);
            }
        }
    }

    /// Lists are as long as there are detections, or empty.
    fn finish(self, beside: &mut Beside) {
        for (attribute, (mut labels, _)) in self.of {
            labels.of.resize(beside.times_s.len(), None);
            beside.attributes.insert(attribute.name(), labels);
        }
        if beside.heights_m.iter().all(Option::is_none) {
            beside.heights_m.clear();
        }
    }
}
