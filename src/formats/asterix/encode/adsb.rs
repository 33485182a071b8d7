//! Reports of ADS-B as category 021, edition 2.7.

use super::record::{
    Record, address, angle, blocks, both, callsign, geographic, mode_a, signed, time_of_day,
    unsigned,
};
use crate::formats::asterix::items::Source;
use crate::formats::asterix::octets::{FOOT, QUARTER_LEVEL_FT, SPEED_STEP};
use crate::formats::asterix::uap::{Uap, editions_of};
use crate::formats::feed::Motion;

/// One report.
#[derive(Debug, Clone, PartialEq)]
pub struct AdsbRecord {
    pub source: Source,
    pub time_s: f64,
    pub address: u32,
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub geometric_altitude_m: Option<f64>,
    pub level_ft: Option<f64>,
    pub motion: Option<Motion>,
    /// Navigation accuracy category for position, 0 to 15.
    pub nacp: Option<u8>,
    pub is_on_ground: bool,
    pub callsign: Option<String>,
    pub mode_a: Option<u16>,
}

/// Blocks of category 021.
pub fn encode_adsb(reports: &[AdsbRecord]) -> Vec<u8> {
    let Some(edition) = editions_of(21).next() else {
        return Vec::new();
    };
    let uap = Uap::of(edition);
    blocks(21, reports.iter().map(|report| record(report, &uap)))
}

fn record<'t>(report: &AdsbRecord, uap: &'t Uap) -> Record<'t> {
    let mut record = Record::of(&uap.fields, report.source);
    let on_ground = if report.is_on_ground { 0x40 } else { 0 };
    record.put(40, vec![1, on_ground]);
    record.put(73, time_of_day(report.time_s));
    record.put(131, geographic(report.lat_deg, report.lon_deg, 30));
    record.put(80, address(report.address));
    let height = report.geometric_altitude_m;
    record.put(
        140,
        height.and_then(|height_m| signed(height_m, 6.25 * FOOT, 2)),
    );
    let nacp = report.nacp.filter(|nacp| *nacp < 16);
    record.put(90, nacp.map(|nacp| vec![1, nacp << 1]));
    record.put(70, report.mode_a.and_then(mode_a));
    let level = report.level_ft;
    record.put(
        145,
        level.and_then(|level_ft| signed(level_ft, QUARTER_LEVEL_FT, 2)),
    );
    let motion = report.motion.and_then(|motion| {
        // The first bit says that the speed is beyond its range.
        let speed = unsigned(motion.speed_mps, SPEED_STEP, 2);
        both(
            speed.filter(|octets| octets[0] & 0x80 == 0),
            angle(motion.course_rad),
        )
    });
    record.put(160, motion);
    record.put(170, report.callsign.as_deref().and_then(callsign));
    record
}
