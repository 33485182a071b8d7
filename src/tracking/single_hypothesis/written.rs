//! A tracker written down as JSON, every number by its bits.

use super::crossing::Ray;
use super::existence::Counted;
use super::initiation::{Initiator, Point, Waiting};
use super::lifecycle::TrackLifecycleState;
use super::multi_scan::{Beginnings, WrittenBeginnings};
use super::twins::Pair;
use super::undetected::{Intensity, WrittenIntensity};
use super::{ActiveTrack, Memory};
use crate::association::Associator;
use crate::filtering::Filter;
use crate::model::fault::Fault;
use crate::model::sensing::LineOfSight;
use crate::model::sight::clutter::ClutterMap;
use crate::model::state::{GaussianState, Position, PositionCovariance};
use crate::tracking::{Nis, bits};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Changes whenever older writing is not understood any more.
const VERSION: u32 = 4;

#[derive(Serialize, Deserialize)]
struct Written {
    method: String,
    version: u32,
    scans: u32,
    started: u32,
    last_time_s: Option<u64>,
    given: Vec<String>,
    tracks: Vec<WrittenTrack>,
    /// Of each sensor.
    waiting: Vec<Vec<WrittenPoint>>,
    /// Of each sensor.
    beginnings: Vec<WrittenBeginnings>,
    intensity: WrittenIntensity,
    counted: Counted,
    /// Of each sensor.
    #[serde(default)]
    rays: Vec<Vec<WrittenRay>>,
    #[serde(default)]
    twins: Vec<Pair>,
    nis: Nis,
    finders: u64,
    /// The map of clutter of each sensor that learns one.
    maps: Vec<Option<Vec<u64>>>,
    associator: Value,
}

#[derive(Serialize, Deserialize)]
struct WrittenTrack {
    serial: u32,
    life: TrackLifecycleState,
    origin: Option<u32>,
    belief: Vec<u64>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct WrittenPoint {
    scan_index: u32,
    #[serde(with = "bits")]
    time_s: f64,
    sensor: usize,
    detection: u32,
    origin: Option<u32>,
    #[serde(with = "bits")]
    after_s: f64,
    kinematics: Vec<u64>,
    missed: u32,
}

/// Time, place, bearing, its variance and the place's covariance.
#[derive(Serialize, Deserialize)]
struct WrittenRay {
    origin: Option<u32>,
    values: Vec<u64>,
}

pub(super) fn write<F: Filter<K>, const K: usize>(
    memory: &Memory<F::Belief, K>,
    associator: &dyn Associator,
) -> Vec<u8> {
    let tracks = memory.tracks.iter().zip(&memory.beliefs);
    let waiting = memory.initiator.waiting().iter();
    let written = Written {
        method: super::METHOD.name.to_owned(),
        version: VERSION,
        scans: memory.scans,
        started: memory.started,
        last_time_s: memory.last_time_s.map(f64::to_bits),
        given: memory.given.clone(),
        tracks: tracks
            .map(|(track, belief)| write_track::<F, K>(track, belief))
            .collect(),
        waiting: waiting
            .map(|points| points.iter().map(write_waiting).collect())
            .collect(),
        beginnings: memory.beginnings.write(),
        intensity: memory.intensity.write::<F, K>(),
        counted: memory.counted,
        rays: memory
            .rays
            .iter()
            .map(|rays| rays.iter().map(write_ray).collect())
            .collect(),
        twins: memory.twins.clone(),
        nis: memory.nis,
        finders: memory.finders,
        maps: memory
            .maps
            .iter()
            .map(|map| map.as_ref().map(|map| bits::of(map.ratios())))
            .collect(),
        associator: associator.memory(),
    };
    serde_json::to_vec(&written).expect("numbers and names are JSON")
}

/// `maps` are those of a tracker with the same parts.
///
/// # Errors
/// Bytes that are no such writing.
pub(super) fn read<F: Filter<K>, const K: usize>(
    bytes: &[u8],
    maps: &[Option<ClutterMap>],
    associator: &mut dyn Associator,
) -> Result<Memory<F::Belief, K>, Box<Fault>> {
    let written: Written = serde_json::from_slice(bytes).map_err(|error| refuse(&error))?;
    if written.method != super::METHOD.name || written.version != VERSION {
        return Err(refuse(&format!("{} {}", written.method, written.version)));
    }
    let learnt: Vec<Option<ClutterMap>> = written.maps.iter().map(read_map).collect();
    if !learnt.iter().map(cells).eq(maps.iter().map(cells)) {
        return Err(refuse(&"the maps of clutter"));
    }
    let mut memory = Memory {
        tracks: Vec::with_capacity(written.tracks.len()),
        beliefs: Vec::with_capacity(written.tracks.len()),
        given: written.given,
        started: written.started,
        last_time_s: written.last_time_s.map(f64::from_bits),
        scans: written.scans,
        initiator: Initiator::default(),
        beginnings: Beginnings::read(&written.beginnings).ok_or_else(|| refuse(&"a beginning"))?,
        intensity: Intensity::read::<F, K>(&written.intensity)
            .ok_or_else(|| refuse(&"an intensity"))?,
        counted: written.counted,
        rays: Vec::with_capacity(written.rays.len()),
        twins: written.twins,
        nis: written.nis,
        finders: written.finders,
        maps: learnt,
    };
    for track in written.tracks {
        let belief = F::unpack(&bits::values(&track.belief)).ok_or_else(|| refuse(&"a belief"))?;
        let track = ActiveTrack {
            serial: track.serial,
            life: track.life,
            origin: track.origin,
        };
        memory.push(track, belief);
    }
    let mut waiting = Vec::with_capacity(written.waiting.len());
    for points in &written.waiting {
        let points: Option<Vec<Waiting<K>>> = points.iter().map(read_point).collect();
        waiting.push(points.ok_or_else(|| refuse(&"a point"))?);
    }
    memory.initiator = Initiator::with_waiting(waiting);
    for rays in &written.rays {
        let rays: Option<Vec<Ray>> = rays.iter().map(read_ray).collect();
        memory.rays.push(rays.ok_or_else(|| refuse(&"a ray"))?);
    }
    associator
        .recall(&written.associator)
        .map_err(|error| refuse(&error))?;
    Ok(memory)
}

fn read_map(map: &Option<Vec<u64>>) -> Option<ClutterMap> {
    let map = map.as_ref()?;
    Some(ClutterMap::new(bits::values(map)))
}

/// Of a map, if there is one.
fn cells(map: &Option<ClutterMap>) -> Option<usize> {
    map.as_ref().map(|map| map.ratios().len())
}

fn refuse(what: &dyn std::fmt::Display) -> Box<Fault> {
    let detail = format!("this is not what a tracker of these parts wrote down: {what}");
    Box::new(Fault::new("/tracker", "malformed", detail))
}

fn write_track<F: Filter<K>, const K: usize>(
    track: &ActiveTrack,
    belief: &F::Belief,
) -> WrittenTrack {
    let mut values = Vec::new();
    F::pack(belief, &mut values);
    WrittenTrack {
        serial: track.serial,
        life: track.life,
        origin: track.origin,
        belief: bits::of(&values),
    }
}

fn write_waiting<const K: usize>(waiting: &Waiting<K>) -> WrittenPoint {
    write_point(&waiting.point, waiting.missed)
}

pub(super) fn write_point<const K: usize>(point: &Point<K>, missed: u32) -> WrittenPoint {
    let mut values = Vec::new();
    point.state.pack_into(&mut values);
    WrittenPoint {
        scan_index: point.scan_index,
        time_s: point.time_s,
        sensor: point.sensor,
        detection: point.detection,
        origin: point.origin,
        after_s: point.after_s,
        kinematics: bits::of(&values),
        missed,
    }
}

pub(super) fn read_point<const K: usize>(point: &WrittenPoint) -> Option<Waiting<K>> {
    Some(Waiting {
        point: Point {
            scan_index: point.scan_index,
            time_s: point.time_s,
            sensor: point.sensor,
            detection: point.detection,
            origin: point.origin,
            after_s: point.after_s,
            state: GaussianState::unpacked(&bits::values(&point.kinematics))?,
        },
        missed: point.missed,
    })
}

fn write_ray(ray: &Ray) -> WrittenRay {
    let (place_m, spread_m2) = (&ray.sight.place_m, &ray.sight.spread_m2);
    let mut values = vec![ray.time_s, ray.sight.bearing_rad, ray.sight.variance_rad2];
    values.extend(place_m.iter().chain(spread_m2.iter()));
    WrittenRay {
        origin: ray.origin,
        values: bits::of(&values),
    }
}

fn read_ray(ray: &WrittenRay) -> Option<Ray> {
    let values: [f64; 9] = bits::values(&ray.values).try_into().ok()?;
    let [time_s, bearing_rad, variance_rad2, place @ ..] = values;
    Some(Ray {
        time_s,
        origin: ray.origin,
        sight: LineOfSight {
            place_m: Position::new(place[0], place[1]),
            bearing_rad,
            variance_rad2,
            spread_m2: PositionCovariance::from_column_slice(&place[2..]),
        },
        has_crossed: false,
    })
}
