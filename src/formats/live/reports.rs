//! From the reports of a feed to those of scans: times, places in the plane, and which scan each is of, as in datasets.

use super::turns::Turns;
use super::{Listener, LiveReport, ScanKey, ScanKind, no_origin};
use crate::formats::Reading;
use crate::formats::feed::{FRAME_S, Feed, Ground, Report, Spot, measure};
use crate::model::fault::Fault;
use crate::model::scan::Detection;
use std::sync::Arc;

/// Hands on what a feed was given since the last time.
pub struct Reports {
    ground: Ground,
    turns: Turns,
    frame_s: f64,
    offset_s: f64,
    /// Names of sensors by their numbers.
    names: Vec<Arc<str>>,
}

impl Reports {
    /// Makes a feed one that is handed on.
    ///
    /// # Errors
    /// Places of sensors that are not on the Earth.
    pub fn of(feed: &mut Feed, reading: &Reading) -> Result<Self, Vec<Fault>> {
        feed.is_live = true;
        Ok(Reports {
            ground: Ground::of(feed, &[], reading)?,
            turns: Turns::default(),
            frame_s: reading.frame_s.unwrap_or(FRAME_S),
            offset_s: reading.clock_offset_s.unwrap_or_default(),
            names: Vec::new(),
        })
    }

    /// Tells the reports of a feed, and forgets them.
    ///
    /// # Errors
    /// Latitudes without a plane.
    pub fn hand_on(
        &mut self,
        feed: &mut Feed,
        listener: &mut dyn Listener,
    ) -> Result<(), Vec<Fault>> {
        for (sensor, site) in std::mem::take(&mut feed.sites) {
            self.ground.learn(sensor, site);
        }
        for (&sensor, &period_s) in &feed.rotation_s {
            self.turns.rotates(sensor, period_s);
        }
        for (sensor, time_s) in feed.north_s.drain(..) {
            self.turns.north(sensor, time_s + self.offset_s);
        }
        for report in std::mem::take(&mut feed.reports) {
            let live = self.live(feed, report)?;
            feed.units.use_up(u64::from(report.units));
            listener.report(live);
        }
        for warning in feed.warnings.drain(..) {
            listener.warn(warning);
        }
        listener.units(&feed.units);
        Ok(())
    }

    fn live(&mut self, feed: &Feed, mut report: Report) -> Result<LiveReport, Vec<Fault>> {
        report.time_s += self.offset_s;
        if self.names.len() != feed.sensors.names().len() {
            let names = feed.sensors.names().iter();
            self.names = names.map(|name| Arc::from(name.as_str())).collect();
        }
        // Only latitudes have no place without a plane.
        let measurement = measure(&report, &mut self.ground).ok_or_else(no_origin)?;
        Ok(LiveReport {
            sensor: self.names[report.sensor as usize].clone(),
            scan: self.scan(&report),
            time_s: report.time_s,
            detection: Some(Detection {
                measurement,
                origin: None,
                amplitude: None,
            }),
            detection_id: report.unit.to_string(),
            identity: report.identity,
            unit: report.unit,
            units: report.units,
        })
    }

    fn scan(&mut self, report: &Report) -> ScanKey {
        match report.spot {
            Spot::Polar { bearing_rad, .. } => ScanKey {
                number: self.turns.number(report.sensor, report.time_s, bearing_rad),
                kind: ScanKind::Turn,
            },
            _ => ScanKey {
                number: (report.time_s / self.frame_s).floor() as i64,
                kind: ScanKind::Frame,
            },
        }
    }
}
