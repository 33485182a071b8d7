//! Plots and local tracks of a radar as categories 048 and 001, its service messages as 034 and 002.

use super::record::{
    Record, address, angle, blocks, both, callsign, extended, last, mode_a, signed, signed_bits,
    time_of_day, unsigned,
};
use crate::formats::asterix::items::Source;
use crate::formats::asterix::octets::{NM, QUARTER_LEVEL_FT, SPEED_STEP};
use crate::formats::asterix::uap::{Uap, editions_of};
use crate::formats::feed::{Motion, Site};

/// A plot, or a point of a local track where it has a number.
#[derive(Debug, Clone, PartialEq)]
pub struct PlotRecord {
    pub source: Source,
    pub time_s: f64,
    /// Slant range (m), and bearing clockwise from north (rad).
    pub place: Option<(f64, f64)>,
    /// What saw it: 0 nothing, 1 primary, 2 secondary, 3 both; in category 048 up to 7, by Mode S.
    pub detection: u8,
    pub is_simulated: bool,
    pub is_test: bool,
    pub is_tentative: bool,
    pub ends: bool,
    pub mode_a: Option<u16>,
    pub level_ft: Option<f64>,
    pub address: Option<u32>,
    pub callsign: Option<String>,
    pub number: Option<u16>,
    pub motion: Option<Motion>,
}

/// A message of a radar of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkRecord {
    pub source: Source,
    pub time_s: f64,
    /// 1: the antenna passes north, 2: the beginning of a sector.
    pub kind: u8,
    /// Where the sector begins, in 1/256 of a turn.
    pub sector: Option<u8>,
    pub rotation_s: Option<f64>,
    /// Category 034 alone says it.
    pub site: Option<Site>,
}

/// Blocks of category 048.
pub fn encode_plots(plots: &[PlotRecord]) -> Vec<u8> {
    let Some(edition) = editions_of(48).next() else {
        return Vec::new();
    };
    let uap = Uap::of(edition);
    let record = |plot: &PlotRecord| {
        let mut record = Record::of(&uap.fields, plot.source);
        record.put(140, time_of_day(plot.time_s));
        let first = plot.detection << 5 | bit(plot.is_simulated, 0x10);
        record.put(20, extended(&[first, bit(plot.is_test, 0x80)]));
        put_target(&mut record, plot, NM / 256.0);
        record.put(220, plot.address.and_then(address));
        record.put(240, plot.callsign.as_deref().and_then(callsign));
        let number = plot.number.filter(|number| *number < 1 << 12);
        record.put(161, number.map(|number| last(u64::from(number), 2)));
        record
    };
    blocks(48, plots.iter().map(record))
}

/// Blocks of category 001. Its times are those of a day modulo 512 s.
pub fn encode_plots_001(plots: &[PlotRecord]) -> Vec<u8> {
    let Some(edition) = editions_of(1).next() else {
        return Vec::new();
    };
    let uap = Uap::of(edition);
    let record = |plot: &PlotRecord| {
        let of_track = uap
            .fields_of_track
            .as_ref()
            .filter(|_| plot.number.is_some());
        let mut record = Record::of(of_track.unwrap_or(&uap.fields), plot.source);
        let truncated = time_of_day(plot.time_s).map(|octets| octets[1..].to_vec());
        record.put(141, truncated);
        let first = bit(of_track.is_some(), 0x80)
            | bit(plot.is_simulated, 0x40)
            | (plot.detection & 3) << 4;
        record.put(20, extended(&[first, bit(plot.is_test, 0x80)]));
        put_target(&mut record, plot, NM / 128.0);
        record.put(161, plot.number.map(|number| last(u64::from(number), 2)));
        record
    };
    blocks(1, plots.iter().map(record))
}

/// What both categories say alike.
fn put_target(record: &mut Record, plot: &PlotRecord, range_step_m: f64) {
    let place = plot.place.and_then(|(range_m, bearing_rad)| {
        both(unsigned(range_m, range_step_m, 2), angle(bearing_rad))
    });
    record.put(40, place);
    record.put(70, plot.mode_a.and_then(mode_a));
    let level = plot.level_ft;
    let level = level.and_then(|level_ft| signed_bits(level_ft, QUARTER_LEVEL_FT, 14));
    record.put(90, level.map(|bits| last(bits, 2)));
    let motion = plot.motion.and_then(|motion| {
        both(
            unsigned(motion.speed_mps, SPEED_STEP, 2),
            angle(motion.course_rad),
        )
    });
    record.put(200, motion);
    if plot.number.is_some() {
        let status = [bit(plot.is_tentative, 0x80), bit(plot.ends, 0x80)];
        record.put(170, extended(&status));
    }
}

fn bit(is_set: bool, bit: u8) -> u8 {
    if is_set { bit } else { 0 }
}

/// Blocks of category 034.
pub fn encode_marks(marks: &[MarkRecord]) -> Vec<u8> {
    encode_service(34, marks)
}

/// Blocks of category 002.
pub fn encode_marks_002(marks: &[MarkRecord]) -> Vec<u8> {
    encode_service(2, marks)
}

fn encode_service(category: u8, marks: &[MarkRecord]) -> Vec<u8> {
    let Some(edition) = editions_of(category).next() else {
        return Vec::new();
    };
    let uap = Uap::of(edition);
    let record = |mark: &MarkRecord| {
        let mut record = Record::of(&uap.fields, mark.source);
        record.put(0, vec![mark.kind]);
        record.put(30, time_of_day(mark.time_s));
        record.put(20, mark.sector.map(|sector| vec![sector]));
        let rotation = mark.rotation_s;
        record.put(
            41,
            rotation.and_then(|rotation_s| unsigned(rotation_s, 1.0 / 128.0, 2)),
        );
        record.put(120, mark.site.and_then(site));
        record
    };
    blocks(category, marks.iter().map(record))
}

fn site(site: Site) -> Option<Vec<u8>> {
    let step = 180.0 / 2f64.powi(23);
    let place = both(signed(site.lat_deg, step, 3), signed(site.lon_deg, step, 3));
    both(signed(site.height_m, 1.0, 2), place)
}
