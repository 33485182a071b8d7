//! What waits to begin, written down, every number by its bits.

use super::threes::{Pairs, Three};
use super::{Beginnings, Counts, Layer, OfSensor};
use crate::model::own::{Own, OwnNoise};
use crate::model::pose::{Attitude, Pose, PoseSigmas};
use crate::model::scan::{Detection, Measurement, Scan};
use crate::model::space::Place;
use crate::tracking::bits;
use crate::tracking::single_hypothesis::written::{WrittenPoint, read_point, write_point};
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
pub struct WrittenBeginnings {
    layers: Vec<WrittenLayer>,
    scans: u32,
    counts: Counts,
}

#[derive(Serialize, Deserialize)]
struct WrittenLayer {
    number: u32,
    scan_index: u32,
    #[serde(with = "bits")]
    log_odds: f64,
    scan_number: u32,
    #[serde(with = "bits")]
    time_s: f64,
    sensor: usize,
    pose: Option<Vec<u64>>,
    detections: Vec<WrittenDetection>,
    /// Empty where they have none.
    own: Vec<Vec<u64>>,
    log_clutter_ratios: Vec<u64>,
    pairs: Vec<Vec<[u32; 2]>>,
    /// Layers before, detections and the strain by its bits.
    threes: Vec<([u32; 2], [u32; 3], u64)>,
}

#[derive(Serialize, Deserialize)]
struct WrittenDetection {
    point: WrittenPoint,
    /// Its kind and values, and the amplitude; NaN is what is absent.
    values: Vec<u64>,
    is_used: bool,
}

impl<const K: usize> Beginnings<K> {
    pub fn write(&self) -> Vec<WrittenBeginnings> {
        let of_sensor = |sensor: &OfSensor<K>| WrittenBeginnings {
            layers: sensor.layers.iter().map(write_layer).collect(),
            scans: sensor.scans,
            counts: sensor.counts,
        };
        self.0.iter().map(of_sensor).collect()
    }

    /// `None` for what nobody wrote.
    pub fn read(written: &[WrittenBeginnings]) -> Option<Self> {
        let of_sensor = |sensor: &WrittenBeginnings| {
            let layers = sensor.layers.iter().map(read_layer);
            Some(OfSensor {
                layers: layers.collect::<Option<_>>()?,
                spare: Vec::new(),
                scans: sensor.scans,
                counts: sensor.counts,
            })
        };
        let all: Option<Vec<OfSensor<K>>> = written.iter().map(of_sensor).collect();
        let all = all.filter(|all| all.iter().all(is_sound))?;
        Some(Beginnings(all))
    }
}

/// Whether layers follow each other, and pairs and threes name detections that there are.
fn is_sound<const K: usize>(sensor: &OfSensor<K>) -> bool {
    let layers = &sensor.layers;
    layers.iter().enumerate().all(|(index, layer)| {
        let follows = u64::from(layer.number) == u64::from(layers[0].number) + index as u64;
        let mut pairs = layer.pairs.0.iter().enumerate();
        follows
            && pairs.all(|(gap, pairs)| {
                gap >= index || pairs.iter().all(|pair| is_pair(sensor, index, gap, pair))
            })
            && layer
                .threes
                .iter()
                .all(|three| is_three(sensor, index, three))
    })
}

/// Whether there is such a detection so many layers before one.
fn has_detection<const K: usize>(
    sensor: &OfSensor<K>,
    index: usize,
    (before, detection): (usize, u32),
) -> bool {
    let at = index.checked_sub(before);
    let layer = at.and_then(|at| sensor.layers.get(at));
    layer.is_some_and(|layer| (detection as usize) < layer.points.len())
}

fn is_pair<const K: usize>(
    sensor: &OfSensor<K>,
    index: usize,
    gap: usize,
    &[one, two]: &[u32; 2],
) -> bool {
    has_detection(sensor, index, (gap + 1, one)) && has_detection(sensor, index, (0, two))
}

fn is_three<const K: usize>(sensor: &OfSensor<K>, index: usize, three: &Three) -> bool {
    let ([first, second], [one, two, last]) = (three.before, three.detections);
    first > second
        && second > 0
        && has_detection(sensor, index, (first as usize, one))
        && has_detection(sensor, index, (second as usize, two))
        && has_detection(sensor, index, (0, last))
}

fn write_layer<const K: usize>(layer: &Layer<K>) -> WrittenLayer {
    let scan = &layer.scan;
    let detections = scan.detections.iter().zip(&layer.points);
    let write = |((detection, point), is_used): ((&Detection, _), &bool)| WrittenDetection {
        point: write_point(point, 0),
        values: write_detection(detection),
        is_used: *is_used,
    };
    let threes = layer.threes.iter();
    WrittenLayer {
        number: layer.number,
        scan_index: layer.scan_index,
        log_odds: layer.log_odds,
        scan_number: scan.number,
        time_s: scan.time_s,
        sensor: scan.sensor,
        pose: scan.pose.as_ref().map(write_pose),
        detections: detections.zip(&layer.is_used).map(write).collect(),
        own: scan.own.iter().map(write_own).collect(),
        log_clutter_ratios: bits::of(&layer.log_clutter_ratios),
        pairs: layer.pairs.0.clone(),
        threes: threes
            .map(|three| (three.before, three.detections, three.strain.to_bits()))
            .collect(),
    }
}

fn read_layer<const K: usize>(written: &WrittenLayer) -> Option<Layer<K>> {
    let pose = written.pose.as_ref().map(|values| read_pose(values));
    let mut layer = Layer::new(Scan {
        number: written.scan_number,
        time_s: written.time_s,
        sensor: written.sensor,
        pose: match pose {
            Some(pose) => Some(pose?),
            None => None,
        },
        detections: Vec::with_capacity(written.detections.len()),
        own: Vec::with_capacity(written.own.len()),
    });
    layer.number = written.number;
    layer.scan_index = written.scan_index;
    layer.log_odds = written.log_odds;
    for detection in &written.detections {
        let point = read_point(&detection.point)?.point;
        let read = read_detection(&detection.values, point.origin)?;
        layer.points.push(point);
        layer.scan.detections.push(read);
    }
    for own in &written.own {
        layer.scan.own.push(read_own(own)?);
    }
    layer.log_clutter_ratios = bits::values(&written.log_clutter_ratios);
    let count = layer.points.len();
    let has_each = |list: usize| list == 0 || list == count;
    if !has_each(layer.scan.own.len()) || !has_each(layer.log_clutter_ratios.len()) {
        return None;
    }
    layer.arrange();
    let is_used = written.detections.iter().map(|detection| detection.is_used);
    layer.is_used = is_used.collect();
    layer.pairs = Pairs(written.pairs.clone());
    let threes = written.threes.iter();
    layer.threes = threes
        .map(|&(before, detections, strain)| Three {
            before,
            detections,
            strain: f64::from_bits(strain),
        })
        .collect();
    Some(layer)
}

/// What is absent is NaN.
fn or_nan(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

fn unless_nan(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

fn write_detection(detection: &Detection) -> Vec<u64> {
    const NONE: f64 = f64::NAN;
    let (kind, values) = match detection.measurement {
        Measurement::Position { x_m, y_m } => (0.0, [x_m, y_m, NONE, NONE]),
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        } => (1.0, [range_m, bearing_rad, or_nan(range_rate_mps), NONE]),
        Measurement::Bearing { bearing_rad } => (2.0, [bearing_rad, NONE, NONE, NONE]),
        Measurement::Position3 { x_m, y_m, z_m } => (3.0, [x_m, y_m, z_m, NONE]),
        Measurement::RangeBearingElevation {
            range_m,
            bearing_rad,
            elevation_rad,
            range_rate_mps,
        } => {
            let rate = or_nan(range_rate_mps);
            (4.0, [range_m, bearing_rad, elevation_rad, rate])
        }
        Measurement::BearingElevation {
            bearing_rad,
            elevation_rad,
        } => (5.0, [bearing_rad, elevation_rad, NONE, NONE]),
    };
    let [a, b, c, d] = values;
    bits::of(&[kind, a, b, c, d, or_nan(detection.amplitude)])
}

fn read_detection(values: &[u64], origin: Option<u32>) -> Option<Detection> {
    let values: [f64; 6] = bits::values(values).try_into().ok()?;
    let [kind, a, b, c, d, amplitude] = values;
    let measurement = match kind {
        0.0 => Measurement::Position { x_m: a, y_m: b },
        1.0 => Measurement::RangeBearing {
            range_m: a,
            bearing_rad: b,
            range_rate_mps: unless_nan(c),
        },
        2.0 => Measurement::Bearing { bearing_rad: a },
        3.0 => Measurement::Position3 {
            x_m: a,
            y_m: b,
            z_m: c,
        },
        4.0 => Measurement::RangeBearingElevation {
            range_m: a,
            bearing_rad: b,
            elevation_rad: c,
            range_rate_mps: unless_nan(d),
        },
        5.0 => Measurement::BearingElevation {
            bearing_rad: a,
            elevation_rad: b,
        },
        _ => return None,
    };
    Some(Detection {
        measurement,
        origin,
        amplitude: unless_nan(amplitude),
    })
}

fn write_own(own: &Own) -> Vec<u64> {
    let [vx, vy] = own.velocity_mps.unwrap_or([f64::NAN; 2]);
    let mut values = vec![own.after_s, vx, vy];
    values.extend(own.noise.values().map(or_nan));
    bits::of(&values)
}

fn read_own(values: &[u64]) -> Option<Own> {
    let values = bits::values(values);
    let (&[after_s, vx, vy], noise) = values.split_first_chunk()?;
    let noise: [f64; 10] = noise.try_into().ok()?;
    Some(Own {
        after_s,
        noise: OwnNoise::from_values(noise.map(unless_nan)),
        velocity_mps: unless_nan(vx).map(|vx| [vx, vy]),
    })
}

fn write_pose(pose: &Pose) -> Vec<u64> {
    let sigmas = &pose.sigmas;
    let places = [pose.place, pose.velocity, sigmas.place, sigmas.velocity];
    let mut values: Vec<f64> = places
        .iter()
        .flat_map(|place| place.iter().copied())
        .collect();
    values.extend([sigmas.heading_rad, sigmas.pitch_rad, sigmas.roll_rad]);
    let told = pose.attitude;
    values.extend(
        told.map(|at| [at.heading_rad, at.pitch_rad, at.roll_rad])
            .into_iter()
            .flatten(),
    );
    bits::of(&values)
}

fn read_pose(values: &[u64]) -> Option<Pose> {
    let values = bits::values(values);
    let (places, angles) = values.split_first_chunk::<12>()?;
    let place = |nth: usize| Place::from_column_slice(&places[3 * nth..3 * nth + 3]);
    let (&[heading_rad, pitch_rad, roll_rad], attitude) = angles.split_first_chunk()?;
    Some(Pose {
        place: place(0),
        velocity: place(1),
        sigmas: PoseSigmas {
            place: place(2),
            velocity: place(3),
            heading_rad,
            pitch_rad,
            roll_rad,
        },
        attitude: match *attitude {
            [] => None,
            [heading_rad, pitch_rad, roll_rad] => Some(Attitude {
                heading_rad,
                pitch_rad,
                roll_rad,
            }),
            _ => return None,
        },
    })
}
