//! A tracker written down as JSON, every number by its bits.

use super::initiation::{Initiator, Point, Waiting};
use super::lifecycle::TrackLifecycleState;
use super::{ActiveTrack, Memory};
use crate::association::Associator;
use crate::filtering::Filter;
use crate::model::fault::Fault;
use crate::model::sight::clutter::ClutterMap;
use crate::model::state::GaussianState;
use crate::tracking::{Nis, bits};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Changes whenever older writing is not understood any more.
const VERSION: u32 = 2;

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
    nis: Nis,
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
struct WrittenPoint {
    scan_index: u32,
    #[serde(with = "bits")]
    time_s: f64,
    sensor: usize,
    detection: u32,
    origin: Option<u32>,
    kinematics: Vec<u64>,
    missed: u32,
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
            .map(|points| points.iter().map(write_point).collect())
            .collect(),
        nis: memory.nis,
        maps: memory
            .maps
            .iter()
            .map(|map| map.as_ref().map(|map| bits::of(map.ratios())))
            .collect(),
        associator: associator.memory(),
    };
    serde_json::to_vec(&written).expect("numbers and names are JSON")
}

/// # Errors
/// Bytes that are no such writing.
pub(super) fn read<F: Filter<K>, const K: usize>(
    bytes: &[u8],
    associator: &mut dyn Associator,
) -> Result<Memory<F::Belief, K>, Box<Fault>> {
    let written: Written = serde_json::from_slice(bytes).map_err(|error| refuse(&error))?;
    if written.method != super::METHOD.name || written.version != VERSION {
        return Err(refuse(&format!("{} {}", written.method, written.version)));
    }
    let read_map = |map: &Option<Vec<u64>>| {
        let map = map.as_ref()?;
        Some(ClutterMap::new(bits::values(map)))
    };
    let mut memory = Memory {
        tracks: Vec::with_capacity(written.tracks.len()),
        beliefs: Vec::with_capacity(written.tracks.len()),
        given: written.given,
        started: written.started,
        last_time_s: written.last_time_s.map(f64::from_bits),
        scans: written.scans,
        initiator: Initiator::default(),
        nis: written.nis,
        maps: written.maps.iter().map(read_map).collect(),
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
    associator
        .recall(&written.associator)
        .map_err(|error| refuse(&error))?;
    Ok(memory)
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

fn write_point<const K: usize>(waiting: &Waiting<K>) -> WrittenPoint {
    let point = &waiting.point;
    let mut values = Vec::new();
    point.state.pack_into(&mut values);
    WrittenPoint {
        scan_index: point.scan_index,
        time_s: point.time_s,
        sensor: point.sensor,
        detection: point.detection,
        origin: point.origin,
        kinematics: bits::of(&values),
        missed: waiting.missed,
    }
}

fn read_point<const K: usize>(point: &WrittenPoint) -> Option<Waiting<K>> {
    Some(Waiting {
        point: Point {
            scan_index: point.scan_index,
            time_s: point.time_s,
            sensor: point.sensor,
            detection: point.detection,
            origin: point.origin,
            state: GaussianState::unpacked(&bits::values(&point.kinematics))?,
        },
        missed: point.missed,
    })
}
