//! What the records of each category say.

mod adsb;
mod radar;
mod surface;
mod system;

use super::octets::{Callsign, time_of_day, unsigned};
use super::uap::Uap;
use super::walk::Items;
use crate::formats::feed::{Motion, Site, Spot};
use crate::model::dataset::DatasetKind;

/// Area and identification code of a source (SAC, SIC).
pub type Source = (u8, u8);

/// A time that a record says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeSaid {
    /// Since midnight (s).
    OfDay(f64),
    /// The same, modulo 512 s.
    Truncated(f64),
}

/// What a record says.
pub enum Said {
    Target(Target),
    Service(Service),
}

/// A report of a target, or a point of a track.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Target {
    pub source: Option<Source>,
    pub time: Option<TimeSaid>,
    pub spot: Option<Spot>,
    /// Above standard pressure where that is said, else above the ellipsoid or the sea.
    pub height_m: Option<f64>,
    /// Pressure altitude as the transponder says it.
    pub mode_c_ft: Option<f64>,
    pub motion: Option<Motion>,
    /// Standard deviation on each axis, of the position as it is given, and of the track's.
    pub sigma_m: Option<f64>,
    pub track_sigma_m: Option<f64>,
    /// A value of the attribute `report_kind`.
    pub report_kind: Option<&'static str>,
    pub address: Option<u32>,
    pub callsign: Option<Callsign>,
    pub mode_a: Option<u16>,
    pub number: Option<u16>,
    pub on_ground: Option<bool>,
    /// What it is instead of an aircraft or a vehicle, as ignored units are called.
    pub special: Option<&'static str>,
    /// The sensor saw nothing at this time.
    pub is_extrapolated: bool,
    pub is_tentative: bool,
    pub is_coasted: bool,
    pub begins: bool,
    pub ends: bool,
}

/// A message of a sensor of itself.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Service {
    pub source: Option<Source>,
    pub of_day_s: Option<f64>,
    /// The antenna passes north.
    pub is_north: bool,
    pub rotation_s: Option<f64>,
    pub site: Option<Site>,
}

/// Kinds of datasets that targets of a category can be, the default first; none of service messages.
pub fn kinds_of(category: u8) -> &'static [DatasetKind] {
    match category {
        1 | 10 | 20 | 48 => &[DatasetKind::Detections, DatasetKind::Tracks],
        11 | 62 => &[DatasetKind::Tracks],
        21 => &[DatasetKind::Truth, DatasetKind::Detections],
        _ => &[],
    }
}

pub fn said(uap: &Uap, items: &Items) -> Said {
    match uap.edition.category {
        1 => Said::Target(radar::plot_or_track(items)),
        2 => Said::Service(radar::service(items)),
        10 if !is_report(items) => Said::Service(service(items, 140)),
        10 => Said::Target(surface::movement(items)),
        11 if !is_report(items) => Said::Service(service(items, 140)),
        11 => Said::Target(surface::fused(items)),
        20 => Said::Target(surface::multilateration(items)),
        21 if uap.is_draft() => Said::Target(adsb::draft_report(items)),
        21 => Said::Target(adsb::report(items)),
        34 => Said::Service(radar::service(items)),
        48 => Said::Target(radar::target(items)),
        62 => Said::Target(system::track(items)),
        _ => Said::Service(service(items, 30)),
    }
}

/// Whether the type of a message, where it is said, is that of target reports.
fn is_report(items: &Items) -> bool {
    items.get(0).is_none_or(|kind| kind == [1])
}

fn service(items: &Items, time: u16) -> Service {
    Service {
        source: source(items),
        of_day_s: items.get(time).map(time_of_day),
        ..Service::default()
    }
}

fn source(items: &Items) -> Option<Source> {
    items.get(10).map(|item| (item[0], item[1]))
}

fn of_day(items: &Items, number: u16) -> Option<TimeSaid> {
    let item = items.get(number)?;
    Some(TimeSaid::OfDay(time_of_day(item)))
}

fn address(item: &[u8]) -> u32 {
    unsigned(item) as u32
}

/// One standard deviation for both axes.
fn on_each_axis((x, y): (f64, f64)) -> f64 {
    (x.hypot(y)) / std::f64::consts::SQRT_2
}

/// What is counted of a target that is simulated, a test or a fixed transponder.
fn special(is_simulated: bool, is_test: bool, is_monitor: bool) -> Option<&'static str> {
    match (is_simulated, is_test, is_monitor) {
        (true, ..) => Some("simulated target"),
        (_, true, _) => Some("test target"),
        (.., true) => Some("field monitor"),
        _ => None,
    }
}
