//! Boxes that a detector found, as detections in the plane of the picture: a pixel stands for a metre, a frame for a second.

use crate::model::boxes::ObjectBox;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::sensor::SensorSettings;

/// Noise of a box's middle, of which the file says nothing (pixels).
const SIGMA_PX: f64 = 5.0;

/// The middles of boxes by frame; y counts upwards from the picture's top, so that it is negative. The confidence is the amplitude. A
/// frame is `frame_s` long, frame 1 begins at 0; frames without boxes are missing from the numbers of the scans.
///
/// # Errors
/// What no recording may have.
pub fn recording(mut boxes: Vec<ObjectBox>, frame_s: f64) -> Result<Dataset, Vec<Fault>> {
    boxes.sort_by_key(|one| one.frame);
    let mut parts = RecordingParts {
        sensors: vec![SensorSettings {
            sigma_x_m: Some(SIGMA_PX),
            sigma_y_m: Some(SIGMA_PX),
            ..SensorSettings::named("camera")
        }],
        ..RecordingParts::default()
    };
    for of_frame in boxes.chunk_by(|one, next| one.frame == next.frame) {
        let frame = of_frame[0].frame;
        parts.scans.push(Scan {
            number: frame,
            time_s: f64::from(frame - 1) * frame_s,
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections: of_frame.iter().map(detection).collect(),
        });
        let ids = (1..=of_frame.len()).map(|number| format!("{frame}.{number}"));
        parts.detection_ids.extend(ids);
    }
    Ok(Dataset::Detections(Recording::new(parts)?))
}

fn detection(one: &ObjectBox) -> Detection {
    let x_m = one.left_px + one.width_px / 2.0;
    let y_m = -(one.top_px + one.height_px / 2.0);
    Detection {
        measurement: Measurement::Position { x_m, y_m },
        origin: None,
        amplitude: Some(one.confidence),
    }
}
