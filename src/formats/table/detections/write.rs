//! Detections as rows, with the columns that their recording needs.

use crate::formats::table::Sink;
use crate::formats::table::degrees::degrees;
use crate::model::scan::{Detection, Measurement, Recording, Scan};
use std::io;

/// Writes every detection, and a row without one for each scan that saw nothing.
///
/// # Errors
/// What the output says.
pub fn write(recording: &Recording, sink: &mut dyn Sink) -> io::Result<()> {
    let layout = Layout::for_recording(recording);
    sink.begin(&layout.columns())?;
    for (first, scan) in recording.scans_with_firsts() {
        if scan.detections.is_empty() {
            write_row(recording, scan, None, layout, sink)?;
        }
        for found in (first..).zip(&scan.detections) {
            write_row(recording, scan, Some(found), layout, sink)?;
        }
    }
    Ok(())
}

/// Which optional columns a recording needs.
#[derive(Clone, Copy)]
struct Layout {
    position: bool,
    range: bool,
    bearing: bool,
    range_rate: bool,
    amplitude: bool,
    origin: bool,
    z: bool,
}

impl Layout {
    fn for_recording(recording: &Recording) -> Self {
        let has = |wanted: fn(&Measurement) -> bool| {
            recording
                .detections()
                .any(|detection| wanted(&detection.measurement))
        };
        let range = has(|measurement| matches!(measurement, Measurement::RangeBearing { .. }));
        let bearing =
            range || has(|measurement| matches!(measurement, Measurement::Bearing { .. }));
        let range_rate = has(|measurement| {
            matches!(
                measurement,
                Measurement::RangeBearing {
                    range_rate_mps: Some(_),
                    ..
                }
            )
        });
        let amplitude = recording
            .detections()
            .any(|detection| detection.amplitude.is_some());
        let position =
            !bearing || has(|measurement| matches!(measurement, Measurement::Position { .. }));
        Layout {
            position,
            range,
            bearing,
            range_rate,
            amplitude,
            origin: recording.origins_known,
            z: recording.is_in_volume(),
        }
    }

    fn columns(self) -> Vec<&'static str> {
        let mut columns = vec!["time_s", "scan", "sensor_id", "detection_id"];
        columns.extend(
            self.position
                .then_some(["x_m", "y_m"])
                .into_iter()
                .flatten(),
        );
        columns.extend(self.z.then_some("z_m"));
        columns.extend(self.range.then_some("range_m"));
        columns.extend(self.bearing.then_some("bearing_deg"));
        columns.extend(self.range_rate.then_some("range_rate_mps"));
        columns.extend(self.amplitude.then_some("amplitude"));
        columns.extend(self.origin.then_some("truth_id"));
        columns
    }
}

fn write_row(
    recording: &Recording,
    scan: &Scan,
    found: Option<(usize, &Detection)>,
    layout: Layout,
    sink: &mut dyn Sink,
) -> io::Result<()> {
    let detection = found.map(|(_, detection)| detection);
    sink.number(Some(scan.time_s))?;
    sink.number(Some(f64::from(scan.number)))?;
    sink.text(Some(&recording.sensors[scan.sensor].sensor_id))?;
    sink.text(found.map(|(index, _)| recording.detection_ids[index].as_str()))?;
    let (position, range_m, bearing_rad, range_rate_mps) =
        match detection.map(|detection| detection.measurement) {
            Some(Measurement::Position { x_m, y_m }) => (Some([x_m, y_m]), None, None, None),
            Some(Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            }) => (None, Some(range_m), Some(bearing_rad), range_rate_mps),
            Some(Measurement::Bearing { bearing_rad }) => (None, None, Some(bearing_rad), None),
            None => (None, None, None, None),
        };
    if layout.position {
        sink.number(position.map(|[x_m, _]| x_m))?;
        sink.number(position.map(|[_, y_m]| y_m))?;
    }
    if layout.z {
        let z_m = found.and_then(|(index, _)| recording.z_m.get(index).copied());
        sink.number(z_m.flatten())?;
    }
    if layout.range {
        sink.number(range_m)?;
    }
    if layout.bearing {
        sink.number(bearing_rad.map(degrees))?;
    }
    if layout.range_rate {
        sink.number(range_rate_mps)?;
    }
    if layout.amplitude {
        sink.number(detection.and_then(|detection| detection.amplitude))?;
    }
    if layout.origin {
        let origin = detection.and_then(|detection| detection.origin);
        sink.text(origin.map(|origin| recording.targets[origin as usize].as_str()))?;
    }
    sink.end_row()
}
