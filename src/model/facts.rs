//! What is known of a recording without reading it again: enough to tell whether a request can work with it.

use super::pose::{Attitude, Pose};
use super::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use super::sensor::SensorSettings;
use serde::{Deserialize, Serialize};

/// What a recording holds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordingFacts {
    pub sensors: Vec<SensorFacts>,
    /// Whether it says which target each detection came from (a column `truth_id`).
    pub origins_known: bool,
}

/// What one sensor of it reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensorFacts {
    /// What the file says of the sensor.
    pub settings: SensorSettings,
    pub scans: u64,
    pub detections: u64,
    /// Detections with a position, with a range and a bearing, and with a bearing alone.
    pub positions: u64,
    pub ranges: u64,
    pub bearings: u64,
    /// Detections that have a range rate, or an amplitude, too.
    pub range_rates: u64,
    pub amplitudes: u64,
    /// Of the positions those with a height, of the ranges and of the bearings those with an elevation.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub heights: u64,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub elevations: u64,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub bearing_elevations: u64,
    /// Scans that say where the sensor is, and how it is turned.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub poses: u64,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub headings: u64,
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

impl RecordingFacts {
    pub fn from_recording(recording: &Recording) -> Self {
        let mut sensors: Vec<SensorFacts> = recording
            .sensors
            .iter()
            .cloned()
            .map(SensorFacts::nothing)
            .collect();
        for scan in &recording.scans {
            let facts = &mut sensors[scan.sensor];
            facts.scans += 1;
            facts.poses += u64::from(scan.pose.is_some());
            let is_turned = scan.pose.is_some_and(|pose| pose.attitude.is_some());
            facts.headings += u64::from(is_turned);
            scan.detections
                .iter()
                .for_each(|detection| facts.count(detection));
        }
        RecordingFacts {
            sensors,
            origins_known: recording.origins_known,
        }
    }

    /// Those of the named sensors; all where none are named.
    #[must_use]
    pub fn only(&self, sensor_ids: Option<&[String]>) -> Self {
        let is_wanted = |facts: &&SensorFacts| {
            sensor_ids.is_none_or(|wanted| wanted.contains(&facts.settings.sensor_id))
        };
        RecordingFacts {
            sensors: self.sensors.iter().filter(is_wanted).cloned().collect(),
            origins_known: self.origins_known,
        }
    }

    /// A small recording of the same kind: of each sensor a scan with one detection of each kind that it reports.
    pub fn sample(&self) -> Recording {
        let mut parts = RecordingParts {
            origins_known: self.origins_known,
            ..Default::default()
        };
        for (sensor, facts) in self.sensors.iter().enumerate() {
            let amplitude = (facts.amplitudes == facts.detections).then_some(1.0);
            let detection = |measurement| Detection {
                measurement,
                origin: None,
                amplitude,
            };
            parts.sensors.push(facts.settings.clone());
            parts.scans.push(Scan {
                number: sensor as u32 + 1,
                time_s: 0.0,
                sensor,
                pose: facts.pose(),
                own: Vec::new(),
                detections: facts.measurements().map(detection).collect(),
            });
        }
        parts.detection_ids = (0..parts.detections().count())
            .map(|index| index.to_string())
            .collect();
        // Every index is in range by construction.
        Recording::new(parts).unwrap_or_default()
    }
}

impl SensorFacts {
    fn nothing(settings: SensorSettings) -> Self {
        SensorFacts {
            settings,
            scans: 0,
            detections: 0,
            positions: 0,
            ranges: 0,
            bearings: 0,
            range_rates: 0,
            amplitudes: 0,
            heights: 0,
            elevations: 0,
            bearing_elevations: 0,
            poses: 0,
            headings: 0,
        }
    }

    fn count(&mut self, detection: &Detection) {
        self.detections += 1;
        self.amplitudes += u64::from(detection.amplitude.is_some());
        match detection.measurement {
            Measurement::Position { .. } => self.positions += 1,
            Measurement::RangeBearing { range_rate_mps, .. } => {
                self.ranges += 1;
                self.range_rates += u64::from(range_rate_mps.is_some());
            }
            Measurement::Bearing { .. } => self.bearings += 1,
            Measurement::Position3 { .. } => {
                self.positions += 1;
                self.heights += 1;
            }
            Measurement::RangeBearingElevation { range_rate_mps, .. } => {
                self.ranges += 1;
                self.elevations += 1;
                self.range_rates += u64::from(range_rate_mps.is_some());
            }
            Measurement::BearingElevation { .. } => {
                self.bearings += 1;
                self.bearing_elevations += 1;
            }
        }
    }

    /// That of a scan, where all have one.
    fn pose(&self) -> Option<Pose> {
        let is_moving = self.scans > 0 && self.poses == self.scans;
        let is_turned = self.headings == self.scans;
        is_moving.then(|| Pose {
            attitude: is_turned.then(Attitude::default),
            ..Pose::default()
        })
    }

    /// Where all ranges have an elevation so has the sample, else none: that is how they are used.
    fn measurements(&self) -> impl Iterator<Item = Measurement> {
        let is_spherical = self.elevations > 0 && self.elevations == self.ranges;
        let polar = move |range_rate_mps| match is_spherical {
            true => Measurement::RangeBearingElevation {
                range_m: 1.0,
                bearing_rad: 0.0,
                elevation_rad: 0.0,
                range_rate_mps,
            },
            false => Measurement::RangeBearing {
                range_m: 1.0,
                bearing_rad: 0.0,
                range_rate_mps,
            },
        };
        let (x_m, y_m, z_m, bearing_rad, elevation_rad) = (1.0, 1.0, 0.0, 0.0, 0.0);
        let kinds = [
            (
                self.positions > self.heights,
                Measurement::Position { x_m, y_m },
            ),
            (self.heights > 0, Measurement::Position3 { x_m, y_m, z_m }),
            (self.ranges > self.range_rates, polar(None)),
            (self.range_rates > 0, polar(Some(0.0))),
            (
                self.bearings > self.bearing_elevations,
                Measurement::Bearing { bearing_rad },
            ),
            (
                self.bearing_elevations > 0,
                Measurement::BearingElevation {
                    bearing_rad,
                    elevation_rad,
                },
            ),
        ];
        kinds
            .into_iter()
            .filter(|(is_reported, _)| *is_reported)
            .map(|(_, measurement)| measurement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three ranges of sensor a, two with a rate, and one position of b.
    fn recording() -> Recording {
        let polar = |range_rate_mps| Measurement::RangeBearing {
            range_m: 5.0,
            bearing_rad: 0.5,
            range_rate_mps,
        };
        let measurements = [
            polar(None),
            polar(Some(2.0)),
            polar(Some(3.0)),
            Measurement::Position { x_m: 0.0, y_m: 0.0 },
        ];
        let detection = |(index, measurement): (usize, Measurement)| Detection {
            measurement,
            origin: None,
            amplitude: (index > 2).then_some(1.0),
        };
        let all: Vec<Detection> = measurements
            .into_iter()
            .enumerate()
            .map(detection)
            .collect();
        Recording::new(RecordingParts {
            sensors: vec![SensorSettings::named("a"), SensorSettings::named("b")],
            scans: [(0, 0..3), (1, 3..4)]
                .map(|(sensor, detections)| Scan {
                    number: 1,
                    time_s: 0.0,
                    sensor,
                    pose: None,
                    own: Vec::new(),
                    detections: all[detections].to_vec(),
                })
                .to_vec(),
            detection_ids: ["1", "2", "3", "1"].map(str::to_owned).to_vec(),
            origins_known: true,
            ..Default::default()
        })
        .unwrap()
    }

    #[test]
    fn a_sample_has_the_kinds_that_were_counted() {
        let facts = RecordingFacts::from_recording(&recording());
        let [a, b] = facts.sensors.as_slice() else {
            panic!("two sensors")
        };
        assert_eq!(
            (
                a.scans,
                a.detections,
                a.ranges,
                a.range_rates,
                a.positions,
                a.amplitudes
            ),
            (1, 3, 3, 2, 0, 0)
        );
        assert_eq!(
            (
                b.scans,
                b.detections,
                b.ranges,
                b.range_rates,
                b.positions,
                b.amplitudes
            ),
            (1, 1, 0, 0, 1, 1)
        );
        let sample = facts.sample();
        assert_eq!(
            (
                sample.sensors.len(),
                sample.detection_count(),
                sample.origins_known
            ),
            (2, 3, true)
        );
        assert_eq!(
            RecordingFacts::from_recording(&facts.only(Some(&["b".to_owned()])).sample()).sensors
                [0]
            .positions,
            1
        );
    }
}
