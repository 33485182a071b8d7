//! A session as a recording: the scans that its tracker took, in their order, as canonical CSV of detections.

use super::entry::{Entry, PushedDetection};
use super::line::{Kept, Line};
use super::scene::Scene;
use super::{EntryFate, Session};
use crate::experiment::files::tables::{number, quoted};
use crate::model::fault::Fault;
use std::fmt::Write;
use std::sync::Arc;

/// Measured columns, in the order in which they are written.
const MEASURED: [&str; 7] = [
    "x_m",
    "y_m",
    "z_m",
    "range_m",
    "bearing_deg",
    "elevation_deg",
    "amplitude",
];

/// Reads a session's log anew, without tracking, to find which scans count.
pub struct SessionRecording {
    session: Session,
    taken: Vec<Kept>,
    /// Tracks that were ended by hand, which a job on the recording does not know.
    pub ended_by_hand: u64,
}

impl SessionRecording {
    pub fn new(scene: Arc<Scene>) -> Self {
        let mut session = Session::new(scene);
        session.line = Line::untracked();
        SessionRecording {
            session,
            taken: Vec::new(),
            ended_by_hand: 0,
        }
    }

    /// Takes the next entry of the log.
    ///
    /// # Errors
    /// None that a session that took it did not have.
    pub fn add(&mut self, entry: Entry) -> Result<(), Box<Fault>> {
        let kept = match &entry {
            Entry::End { .. } => {
                self.ended_by_hand += 1;
                None
            }
            Entry::Scan(scan) if scan.heartbeat => None,
            Entry::Scan(scan) => {
                let sensor = self.session.scene.sensor_index(&scan.sensor_id);
                let scan = scan.clone();
                sensor.map(|sensor| Kept { sensor, scan })
            }
        };
        let fate = self.session.take(entry)?;
        let counts = !matches!(fate, EntryFate::LateDropped | EntryFate::Duplicate);
        self.taken.extend(kept.filter(|_| counts));
        Ok(())
    }

    /// Scans that count so far.
    pub fn scans(&self) -> usize {
        self.taken.len()
    }

    /// The recording as canonical CSV.
    pub fn into_csv(mut self) -> Vec<u8> {
        self.taken.sort_by(|one, other| {
            one.key()
                .partial_cmp(&other.key())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let columns = self.columns();
        let mut text = String::from("time_s,scan,sensor_id,detection_id");
        for column in &columns {
            text.push(',');
            text.push_str(column);
        }
        text.push('\n');
        for (index, kept) in self.taken.iter().enumerate() {
            write_scan(&mut text, kept, index + 1, &columns);
        }
        text.into_bytes()
    }

    /// The measured columns that any sensor has.
    fn columns(&self) -> Vec<&'static str> {
        let scene = &self.session.scene;
        let sensors = 0..scene.sensor_ids().len();
        let fields: Vec<&str> = sensors
            .flat_map(|sensor| scene.reports(sensor).fields())
            .copied()
            .collect();
        let detections = self.taken.iter().flat_map(|kept| &kept.scan.detections);
        let has_amplitude = detections.map(|one| one.amplitude).any(|it| it.is_some());
        let is_there =
            |column: &&str| fields.contains(column) || (*column == "amplitude" && has_amplitude);
        MEASURED.into_iter().filter(is_there).collect()
    }
}

fn write_scan(text: &mut String, kept: &Kept, number_of_scan: usize, columns: &[&str]) {
    let scan = &kept.scan;
    let head = format!(
        "{},{number_of_scan},{}",
        number(scan.time_s),
        quoted(&scan.sensor_id)
    );
    if scan.detections.is_empty() {
        text.push_str(&head);
        text.push(',');
        text.extend(columns.iter().map(|_| ','));
        text.push('\n');
    }
    for (index, detection) in scan.detections.iter().enumerate() {
        text.push_str(&head);
        let id = detection.detection_id.as_deref();
        // Writing to a text does not fail.
        let _ = match id {
            Some(id) => write!(text, ",{}", quoted(id)),
            None => write!(text, ",{}", index + 1),
        };
        for column in columns {
            text.push(',');
            if let Some(value) = detection.value(column) {
                text.push_str(&number(value));
            }
        }
        text.push('\n');
    }
}

impl PushedDetection {
    fn value(&self, column: &str) -> Option<f64> {
        match column {
            "x_m" => self.x_m,
            "y_m" => self.y_m,
            "z_m" => self.z_m,
            "range_m" => self.range_m,
            "bearing_deg" => self.bearing_deg,
            "elevation_deg" => self.elevation_deg,
            _ => self.amplitude,
        }
    }
}
