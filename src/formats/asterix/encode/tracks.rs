//! Tracks as category 062, edition 1.21.

use super::record::{
    Record, address, blocks, both, callsign, compound, extended, geographic, last, mode_a, signed,
    time_of_day, unsigned,
};
use crate::formats::asterix::items::Source;
use crate::formats::asterix::octets::FOOT;
use crate::formats::asterix::uap::{Uap, editions_of};
use crate::model::track::TrackStatus;

/// One point of a track.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackRecord {
    /// SAC and SIC of the system.
    pub source: Source,
    /// Its time of day is written.
    pub time_s: f64,
    pub number: u16,
    pub lat_deg: f64,
    pub lon_deg: f64,
    /// East and north of the system's reference point (m).
    pub place_m: Option<(f64, f64)>,
    /// East and north.
    pub velocity_mps: Option<(f64, f64)>,
    /// Variance east, covariance, variance north (m²).
    pub covariance_m2: Option<[f64; 3]>,
    /// Standard deviations east and north.
    pub velocity_sigma_mps: Option<(f64, f64)>,
    /// Above standard pressure.
    pub pressure_altitude_m: Option<f64>,
    /// Above the ellipsoid.
    pub geometric_altitude_m: Option<f64>,
    pub vertical_rate_mps: Option<f64>,
    pub status: TrackStatus,
    /// The first and the last point of the track.
    pub begins: bool,
    pub ends: bool,
    pub address: Option<u32>,
    pub callsign: Option<String>,
    pub mode_a: Option<u16>,
}

/// Blocks of category 062 with the points in their order.
pub fn encode_tracks(points: &[TrackRecord]) -> Vec<u8> {
    let Some(edition) = editions_of(62).next() else {
        return Vec::new();
    };
    let uap = Uap::of(edition);
    blocks(62, points.iter().map(|point| record(point, &uap)))
}

fn record<'t>(point: &TrackRecord, uap: &'t Uap) -> Record<'t> {
    let mut record = Record::of(&uap.fields, point.source);
    let pair = |(east, north): (f64, f64), step, octets| {
        both(signed(east, step, octets), signed(north, step, octets))
    };
    record.put(70, time_of_day(point.time_s));
    record.put(105, geographic(point.lat_deg, point.lon_deg, 25));
    record.put(100, point.place_m.and_then(|place| pair(place, 0.5, 3)));
    record.put(
        185,
        point
            .velocity_mps
            .and_then(|velocity| pair(velocity, 0.25, 2)),
    );
    record.put(60, point.mode_a.and_then(mode_a));
    let name = point.callsign.as_deref().and_then(callsign);
    record.put(245, name.clone().map(|name| [vec![0], name].concat()));
    let aircraft = parts([point.address.and_then(address), name]);
    record.put(380, aircraft);
    record.put(40, last(u64::from(point.number), 2));
    record.put(80, status(point));
    let level = point.pressure_altitude_m;
    record.put(
        136,
        level.and_then(|height_m| signed(height_m, 25.0 * FOOT, 2)),
    );
    let height = point.geometric_altitude_m;
    record.put(
        130,
        height.and_then(|height_m| signed(height_m, 6.25 * FOOT, 2)),
    );
    let rate = point.vertical_rate_mps;
    record.put(
        220,
        rate.and_then(|rate_mps| signed(rate_mps, 6.25 * FOOT / 60.0, 2)),
    );
    record.put(500, accuracy(point));
    record
}

/// Those that are there, numbered by their places; nothing where none is.
fn parts<const N: usize>(parts: [Option<Vec<u8>>; N]) -> Option<Vec<u8>> {
    let parts: Vec<(usize, Vec<u8>)> = parts
        .into_iter()
        .enumerate()
        .filter_map(|(number, part)| Some((number, part?)))
        .collect();
    (!parts.is_empty()).then(|| compound(parts))
}

/// Geometric altitude the more reliable one, tentative; last, first; nothing; coasted.
fn status(point: &TrackRecord) -> Vec<u8> {
    let is_geometric = point.pressure_altitude_m.is_none() && point.geometric_altitude_m.is_some();
    let bit = |is_set: bool, bit: u8| if is_set { bit } else { 0 };
    extended(&[
        bit(is_geometric, 0x20) | bit(point.status == TrackStatus::Tentative, 0x02),
        bit(point.ends, 0x40) | bit(point.begins, 0x20),
        0,
        bit(point.status == TrackStatus::Coasted, 0x80),
    ])
}

/// A covariance is written as the root of its size, with its sign.
fn accuracy(point: &TrackRecord) -> Option<Vec<u8>> {
    let position = point
        .covariance_m2
        .and_then(|[xx, _, yy]| both(unsigned(xx.sqrt(), 0.5, 2), unsigned(yy.sqrt(), 0.5, 2)));
    let covariance = point
        .covariance_m2
        .and_then(|[_, xy, _]| signed(xy.abs().sqrt().copysign(xy), 0.5, 2));
    let velocity = point
        .velocity_sigma_mps
        .and_then(|(east, north)| both(unsigned(east, 0.25, 1), unsigned(north, 0.25, 1)));
    parts([position, covariance, None, None, None, velocity])
}
