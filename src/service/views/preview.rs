//! The first rows of a dataset, in the canonical columns, as text.

use crate::formats::write_csv;
use crate::model::beside::Beside;
use crate::model::dataset::Dataset;
use crate::model::scan::{Recording, RecordingParts, Scan};
use crate::model::track::{Track, TrackSet};
use crate::model::truth::{Target, TruthSet};
use serde::Serialize;
use utoipa::ToSchema;

/// The first rows of a dataset.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = DatasetPreview)]
pub struct Preview {
    pub columns: Vec<String>,
    /// One list of texts a row, in the order of `columns`.
    pub rows: Vec<Vec<String>>,
    /// Rows of the whole dataset.
    pub total_rows: u64,
}

/// The first `limit` rows.
pub fn of(dataset: &Dataset, limit: usize) -> Preview {
    let head = match dataset {
        Dataset::Detections(recording) => Dataset::Detections(head_of_recording(recording, limit)),
        Dataset::Truth(truth) => Dataset::Truth(head_of_truth(truth, limit)),
        Dataset::Tracks(set) => Dataset::Tracks(head_of_tracks(set, limit)),
        Dataset::TruthBoxes(set) => Dataset::TruthBoxes(set.head(limit)),
        Dataset::TrackBoxes(set) => Dataset::TrackBoxes(set.head(limit)),
        Dataset::BearingTime(record) => Dataset::BearingTime(record.head(limit)),
    };
    let mut text = Vec::new();
    write_csv(&head, &mut text).expect("writing to memory does not fail");
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(text.as_slice());
    let mut rows = reader
        .records()
        .filter_map(Result::ok)
        .map(|row| row.iter().map(str::to_owned).collect());
    let columns = rows.next().unwrap_or_default();
    let summary = dataset.summary();
    // A row of a record is all the cells of one time.
    let total_rows = if let Dataset::BearingTime(_) = dataset {
        summary.scans
    } else {
        summary.rows
    };
    Preview {
        columns,
        rows: rows.take(limit).collect(),
        total_rows,
    }
}

fn head_of_recording(recording: &Recording, limit: usize) -> Recording {
    let count = recording.detection_count().min(limit);
    let cut = |(first, scan): (usize, &Scan)| Scan {
        number: scan.number,
        time_s: scan.time_s,
        sensor: scan.sensor,
        pose: scan.pose,
        own: scan.own.iter().take(count - first).copied().collect(),
        detections: scan
            .detections
            .iter()
            .take(count - first)
            .copied()
            .collect(),
    };
    let scans = recording
        .scans_with_firsts()
        .take_while(|(first, _)| *first < count.max(1))
        .map(cut)
        .collect();
    let mut beside = Beside::default();
    beside.extend(&recording.beside, 0..count);
    let parts = RecordingParts {
        frame: recording.frame,
        time_base: recording.time_base,
        beside,
        sensors: recording.sensors.clone(),
        scans,
        detection_ids: recording.detection_ids[..count].to_vec(),
        targets: recording.targets.clone(),
        origins_known: recording.origins_known,
    };
    Recording::new(parts).expect("the head of a sound recording is sound")
}

fn head_of_truth(truth: &TruthSet, limit: usize) -> TruthSet {
    let mut left = limit;
    let mut head = Vec::new();
    for target in truth.targets() {
        let points: Vec<_> = target.points.iter().take(left).copied().collect();
        left -= points.len();
        head.push(Target {
            truth_id: target.truth_id.clone(),
            points,
        });
        if left == 0 {
            break;
        }
    }
    let mut head = TruthSet::new(truth.space(), head).expect("the head of sound truth is sound");
    (head.frame, head.time_base) = (truth.frame, truth.time_base);
    head.attributes = truth.attributes.clone();
    head.changes = truth.changes.clone();
    head
}

fn head_of_tracks(set: &TrackSet, limit: usize) -> TrackSet {
    let mut left = limit;
    let mut tracks = Vec::new();
    for track in &set.tracks {
        let points = track.points[..track.points.len().min(left)].to_vec();
        left -= points.len();
        tracks.push(Track {
            track_id: track.track_id.clone(),
            points,
        });
        if left == 0 {
            break;
        }
    }
    TrackSet {
        space: set.space,
        frame: set.frame,
        tracks,
        candidates: set.candidates.clone(),
        modes: set.modes.clone(),
        detection_ids: set.detection_ids.clone(),
        sensor_ids: set.sensor_ids.clone(),
        time_base: set.time_base,
        attributes: set.attributes.clone(),
        changes: set.changes.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::views::tests::read;

    #[test]
    fn the_first_rows_are_shown_and_all_are_counted() {
        let dataset = read("time_s,truth_id,x_m,y_m\n0,a,1,2\n1,a,3,4\n0,\"b,c\",5,6\n");
        let preview = of(&dataset, 2);
        assert_eq!(preview.columns, ["time_s", "truth_id", "x_m", "y_m"]);
        assert_eq!((preview.rows.len(), preview.total_rows), (2, 3));
        assert!(of(&dataset, 10).rows.iter().any(|row| row[1] == "b,c"));
    }

    #[test]
    fn a_row_of_a_record_is_a_time() {
        let preview = of(&read("time_s,0,10,20\n0,1,2,3\n1,4,5.5,6\n2,7,8,9\n"), 2);
        assert_eq!((preview.columns.len(), preview.total_rows), (4, 3));
        assert_eq!(preview.rows, [["0", "1", "2", "3"], ["1", "4", "5.5", "6"]]);
    }

    #[test]
    fn a_recording_is_cut_within_a_scan() {
        let dataset = read(
            "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,s,d1,1,2\n0,1,s,d2,3,4\n8,2,s,d3,5,6\n",
        );
        for (limit, rows) in [(1, 1), (2, 2), (3, 3), (9, 3)] {
            assert_eq!(of(&dataset, limit).rows.len(), rows, "limit {limit}");
        }
    }

    #[test]
    fn what_detections_have_of_their_own_is_shown_within_a_scan_too() {
        let dataset = read(
            "time_s,scan,sensor_id,detection_id,x_m,y_m,vx_mps,vy_mps,sigma_x_m\n0,1,s,d1,1,2,3,4,5\n0,1,s,d2,3,4,5,6,7\n",
        );
        let preview = of(&dataset, 1);
        assert_eq!(preview.columns[6..], ["vx_mps", "vy_mps", "sigma_x_m"]);
        assert_eq!(
            preview.rows,
            [["0", "1", "s", "d1", "1", "2", "3", "4", "5"]]
        );
    }
}
