//! ASTERIX category 062: tracks as a surveillance system sends them, in blocks in order of time. Times of day are written, so a
//! reader has to be told the date. Places are latitudes and longitudes, and metres from the origin.

use super::earth::Earth;
use super::{WriteError, Writer};
use crate::formats::asterix::encode::{TrackRecord, encode_tracks};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::track::{Kinematics, Track, TrackPoint, TrackSet, TrackStatus};
use std::io::Write;

pub const WRITER: Writer = Writer {
    name: "asterix",
    media_type: "application/octet-stream",
    extension: "ast",
    summary: "ASTERIX category 062, edition 1.21: tracks for surveillance displays and recorders",
    kinds: &[DatasetKind::Tracks],
    feature: None,
    write,
};

/// Track numbers have 16 bits; 0 is none.
const NUMBERS: usize = 65_535;

fn write(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    let earth = Earth::of(dataset, WRITER.name)?;
    let Dataset::Tracks(set) = dataset else {
        return Err(super::no_places(WRITER.name).into());
    };
    if set.tracks.len() > NUMBERS {
        let detail = format!(
            "there are {} tracks, and {NUMBERS} track numbers",
            set.tracks.len()
        );
        return Err(Fault::new("/format", "too_large", detail).into());
    }
    let mut records = Vec::new();
    for (index, track) in set.tracks.iter().enumerate() {
        let last = track.points.len().saturating_sub(1);
        for (place, point) in track.points.iter().enumerate() {
            let record = record(set, track, point, &earth)?;
            records.push(TrackRecord {
                number: index as u16 + 1,
                begins: place == 0,
                ends: place == last,
                ..record
            });
        }
    }
    records.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.number.cmp(&b.number)));
    out.write_all(&encode_tracks(&records))?;
    Ok(())
}

fn record(
    set: &TrackSet,
    track: &Track,
    point: &TrackPoint,
    earth: &Earth,
) -> Result<TrackRecord, WriteError> {
    let estimate = &point.estimate;
    let spot = earth.spot(point.time_s, &estimate.position, point.height_m)?;
    let known = set.attributes.get(&track.track_id);
    let text = |name: &str| known.and_then(|known| known.get(name)).map(String::as_str);
    let (covariance_m2, velocity_sigma_mps) = spread(estimate);
    Ok(TrackRecord {
        source: (0, 1),
        time_s: point.time_s,
        number: 0,
        lat_deg: spot.lat_deg,
        lon_deg: spot.lon_deg,
        place_m: Some((estimate.position.x, estimate.position.y)),
        velocity_mps: estimate.velocity.map(|velocity| (velocity.x, velocity.y)),
        covariance_m2,
        velocity_sigma_mps,
        pressure_altitude_m: None,
        geometric_altitude_m: spot.height_m,
        vertical_rate_mps: None,
        status: point.status.unwrap_or(TrackStatus::Confirmed),
        begins: false,
        ends: false,
        address: text("address").and_then(|address| u32::from_str_radix(address, 16).ok()),
        callsign: text("callsign").map(str::to_owned),
        mode_a: text("mode_a").and_then(|code| u16::from_str_radix(code, 8).ok()),
    })
}

/// Variance east, covariance, variance north; standard deviations of the velocity.
type Spread = (Option<[f64; 3]>, Option<(f64, f64)>);

fn spread(estimate: &Kinematics) -> Spread {
    let Some(covariance) = estimate.covariance::<4>() else {
        return (None, None);
    };
    let place = [covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]];
    let velocity = (covariance[(2, 2)].sqrt(), covariance[(3, 3)].sqrt());
    (Some(place), Some(velocity))
}
