//! A dataset: detections, truth, tracks or a bearing-time record, as read from a file or made by a job.

use super::bearing_time::BearingTimeRecord;
use super::boxes::BoxSet;
use super::facts::RecordingFacts;
use super::fault::Fault;
use super::scan::Recording;
use super::sensor::SensorSettings;
use super::space::Frame;
use super::time::TimeBase;
use super::track::TrackSet;
use super::truth::TruthSet;
use super::units::Units;
use serde::{Deserialize, Serialize};

/// What a dataset holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum DatasetKind {
    Detections,
    Truth,
    Tracks,
    BearingTime,
}

impl DatasetKind {
    pub const ALL: [DatasetKind; 4] = [
        DatasetKind::Detections,
        DatasetKind::Truth,
        DatasetKind::Tracks,
        DatasetKind::BearingTime,
    ];

    pub fn name(self) -> &'static str {
        match self {
            DatasetKind::Detections => "detections",
            DatasetKind::Truth => "truth",
            DatasetKind::Tracks => "tracks",
            DatasetKind::BearingTime => "bearing_time",
        }
    }
}

/// The content of a dataset.
#[derive(Debug, Clone, PartialEq)]
pub enum Dataset {
    Detections(Recording),
    Truth(TruthSet),
    Tracks(TrackSet),
    /// Truth in the frames of a video.
    TruthBoxes(BoxSet),
    /// Tracks in the frames of a video.
    TrackBoxes(BoxSet),
    BearingTime(BearingTimeRecord),
}

/// What a list of datasets shows of one: its kind, how much is in it, and when.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DatasetSummary {
    pub kind: DatasetKind,
    /// Names of the sensors that made the detections; empty where the file does not say.
    pub sensor_ids: Vec<String>,
    /// Scans of a recording, frames of boxes, times of a bearing-time record; 0 for other truth and tracks.
    pub scans: u64,
    /// Detections, truth points, track points, boxes or cells.
    pub rows: u64,
    /// Targets named by truth or origins, or tracks.
    pub objects: u64,
    /// Boxes have frames, not times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_s: Option<f64>,
    /// Centre of the first cell of a bearing-time record, and of the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_bearing_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_bearing_deg: Option<f64>,
    /// Where on the Earth its origin is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    #[serde(default)]
    pub time_base: TimeBase,
    /// How the units of its file fared; of what a job made there is no file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<Units>,
    /// Of detections; what was kept before this was known has to be read once more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub facts: Option<RecordingFacts>,
}

impl Dataset {
    /// Only what the named sensors saw: the scans of detections, the points of tracks. Everything else has no sensors, and stays.
    ///
    /// # Errors
    /// A fault for each name that is not a sensor of it.
    pub fn only_sensors(self, sensor_ids: &[String]) -> Result<Dataset, Vec<Fault>> {
        match self {
            Dataset::Detections(recording) => {
                recording.only_sensors(sensor_ids).map(Dataset::Detections)
            }
            Dataset::Tracks(tracks) => tracks.only_sensors(sensor_ids).map(Dataset::Tracks),
            other => Ok(other),
        }
    }

    pub fn kind(&self) -> DatasetKind {
        match self {
            Dataset::Detections(_) => DatasetKind::Detections,
            Dataset::Truth(_) | Dataset::TruthBoxes(_) => DatasetKind::Truth,
            Dataset::Tracks(_) | Dataset::TrackBoxes(_) => DatasetKind::Tracks,
            Dataset::BearingTime(_) => DatasetKind::BearingTime,
        }
    }

    pub fn summary(&self) -> DatasetSummary {
        let times_s = self.times_s();
        let (scans, rows, objects) = match self {
            Dataset::Detections(recording) => (
                recording.scans.len(),
                recording.detection_count(),
                recording.targets.len(),
            ),
            Dataset::Truth(truth) => (0, times_s.len(), truth.targets().len()),
            Dataset::Tracks(set) => (0, times_s.len(), set.tracks.len()),
            Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set) => {
                (set.frames(), set.boxes().len(), set.object_ids().len())
            }
            Dataset::BearingTime(record) => (record.times_s.len(), record.levels_db.len(), 0),
        };
        let bearings_deg = match self {
            Dataset::BearingTime(record) => {
                record.bearings_rad.first().zip(record.bearings_rad.last())
            }
            _ => None,
        };
        DatasetSummary {
            kind: self.kind(),
            sensor_ids: self.sensor_ids(),
            scans: scans as u64,
            rows: rows as u64,
            objects: objects as u64,
            start_s: times_s.iter().copied().reduce(f64::min),
            end_s: times_s.iter().copied().reduce(f64::max),
            first_bearing_deg: bearings_deg.map(|(first, _)| first.to_degrees()),
            last_bearing_deg: bearings_deg.map(|(_, last)| last.to_degrees()),
            frame: self.frame(),
            time_base: self.time_base(),
            units: None,
            facts: match self {
                Dataset::Detections(recording) => Some(RecordingFacts::from_recording(recording)),
                _ => None,
            },
        }
    }

    /// Where on the Earth its origin is; boxes and bearing-time records have none.
    pub fn frame(&self) -> Option<Frame> {
        match self {
            Dataset::Detections(recording) => recording.frame,
            Dataset::Truth(truth) => truth.frame,
            Dataset::Tracks(tracks) => tracks.frame,
            Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_) | Dataset::BearingTime(_) => None,
        }
    }

    /// Says where on the Earth its origin is; boxes and bearing-time records have none.
    pub fn place_at(&mut self, frame: Frame) {
        match self {
            Dataset::Detections(recording) => recording.place_at(frame),
            Dataset::Truth(truth) => truth.frame = Some(frame),
            Dataset::Tracks(tracks) => tracks.frame = Some(frame),
            Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_) | Dataset::BearingTime(_) => {}
        }
    }

    /// Adds what is known of the sensors of detections besides; it goes before what they say themselves.
    pub fn describe_sensors(&mut self, known: &[SensorSettings]) {
        let Dataset::Detections(recording) = self else {
            return;
        };
        let mut sensors = recording.sensors.clone();
        for sensor in &mut sensors {
            let same = |known: &&SensorSettings| known.sensor_id == sensor.sensor_id;
            if let Some(known) = known.iter().find(same) {
                *sensor = sensor.overridden_by(known);
            }
        }
        recording.replace_sensors(sensors);
    }

    pub fn set_time_base(&mut self, base: TimeBase) {
        match self {
            Dataset::Detections(recording) => recording.set_time_base(base),
            Dataset::Truth(truth) => truth.time_base = base,
            Dataset::Tracks(tracks) => tracks.time_base = base,
            Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_) | Dataset::BearingTime(_) => {}
        }
    }

    pub fn time_base(&self) -> TimeBase {
        match self {
            Dataset::Detections(recording) => recording.time_base,
            Dataset::Truth(truth) => truth.time_base,
            Dataset::Tracks(tracks) => tracks.time_base,
            Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_) => TimeBase::Relative,
            Dataset::BearingTime(_) => TimeBase::Relative,
        }
    }

    /// Detections, truth points, track points, boxes or cells.
    pub fn row_count(&self) -> usize {
        match self {
            Dataset::Detections(recording) => recording.detection_count(),
            Dataset::Truth(truth) => truth
                .targets()
                .iter()
                .map(|target| target.points.len())
                .sum(),
            Dataset::Tracks(set) => set.tracks.iter().map(|track| track.points.len()).sum(),
            Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set) => set.boxes().len(),
            Dataset::BearingTime(record) => record.levels_db.len(),
        }
    }

    fn sensor_ids(&self) -> Vec<String> {
        match self {
            Dataset::Detections(recording) => {
                let sensors = recording.sensors.iter();
                sensors.map(|sensor| sensor.sensor_id.clone()).collect()
            }
            Dataset::Tracks(set) => set.sensor_ids.clone(),
            _ => Vec::new(),
        }
    }

    /// Times of scans, points or rows; boxes have none.
    fn times_s(&self) -> Vec<f64> {
        match self {
            Dataset::Detections(recording) => {
                recording.scans.iter().map(|scan| scan.time_s).collect()
            }
            Dataset::Truth(truth) => {
                let points = truth.targets().iter().flat_map(|target| &target.points);
                points.map(|point| point.time_s).collect()
            }
            Dataset::Tracks(set) => {
                let points = set.tracks.iter().flat_map(|track| &track.points);
                points.map(|point| point.time_s).collect()
            }
            Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_) => Vec::new(),
            Dataset::BearingTime(record) => record.times_s.clone(),
        }
    }
}
