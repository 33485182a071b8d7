//! When the sensors of a scenario look: each with its own period, first scan and latency, if it says them.

use crate::model::scenario::Scenario;

/// One scan to be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    /// With which the scan is stamped.
    pub time_s: f64,
    /// At which it sees what is there.
    pub made_s: f64,
    pub sensor: usize,
    /// Among the scans of the sensor, from 0.
    pub number: u64,
}

/// All scans from a time on, in order of their stamps, at one time in that of the sensors.
pub(super) fn looks(scenario: &Scenario, start_s: f64) -> Vec<Look> {
    let mut looks = Vec::new();
    for (sensor, settings) in scenario.sensors.iter().enumerate() {
        let latency_s = settings.timing.latency_s.unwrap_or(0.0);
        for (number, after_s) in (0..).zip(settings.scan_times_s(scenario)) {
            let time_s = start_s + after_s;
            looks.push(Look {
                time_s,
                made_s: time_s - latency_s,
                sensor,
                number,
            });
        }
    }
    looks.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.sensor.cmp(&b.sensor)));
    looks
}

/// The times of these, each once.
pub(super) fn times_s(looks: &[Look]) -> Vec<f64> {
    let mut times_s: Vec<f64> = looks.iter().map(|look| look.time_s).collect();
    times_s.dedup();
    times_s
}

/// At how many times there are scans.
pub fn step_count(scenario: &Scenario) -> u64 {
    times_s(&looks(scenario, 0.0)).len() as u64
}
