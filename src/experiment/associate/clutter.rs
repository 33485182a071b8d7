//! Compares the clutter density that the tracker was given with what it left over: a density that is far off misleads
//! every method that weighs detections against it. One that was estimated from the same data says nothing to compare.

use super::track::ResolvedRecording;
use crate::experiment::input::extent::Extent;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::track::TrackSet;

/// Beyond this factor, either way, the report warns.
const TOLERATED_FACTOR: f64 = 3.0;
/// Fewer false detections than this, found and expected, say nothing.
const LEAST_COUNT: f64 = 10.0;

/// A warning for each sensor whose given density disagrees with the detections that no output track was given.
pub fn disagreements(data: &ResolvedRecording, tracks: &TrackSet) -> Vec<String> {
    let ResolvedRecording {
        recording,
        known,
        sensors,
    } = *data;
    let used = used_detections(recording, tracks);
    let warning = |(index, settings): (usize, &SensorSettings)| {
        let sensor = &sensors[index];
        let scans = || recording.scans.iter().filter(|scan| scan.sensor == index);
        let left_over = recording
            .scans_with_firsts()
            .filter(|(_, scan)| scan.sensor == index)
            .flat_map(|(first, scan)| &used[first..first + scan.detections.len()])
            .filter(|is_used| !**is_used)
            .count() as f64;
        let extent = Extent::measure(recording, index, settings, &sensor.report);
        let (unit, watched, given) = (extent.unit(), extent.watched, extent.density_of(settings)?);
        let scanned = watched * scans().count() as f64;
        let expected = given * scanned;
        let is_off =
            left_over > TOLERATED_FACTOR * expected || expected > TOLERATED_FACTOR * left_over;
        (is_off && left_over.max(expected) >= LEAST_COUNT && scanned > 0.0).then(|| {
            format!(
                "sensor '{}': the clutter density {given:.3e} per {unit} disagrees with the data by more than a factor of {TOLERATED_FACTOR}: \
                 {left_over} detections outside every output track in {} scans of {watched:.3e} {unit} are {:.3e} per {unit}",
                sensor.sensor_id,
                scans().count(),
                left_over / scanned
            )
        })
    };
    known.iter().enumerate().filter_map(warning).collect()
}

/// For each detection of the recording, whether an output track more likely took it than not.
fn used_detections(recording: &Recording, tracks: &TrackSet) -> Vec<bool> {
    let mut used = vec![false; recording.detection_count()];
    let points = tracks.tracks.iter().flat_map(|track| &track.points);
    for candidate in points
        .flat_map(|point| tracks.candidates_of(point))
        .filter(|candidate| candidate.probability > 0.5)
    {
        if let Some(detection) = candidate.detection {
            used[detection as usize] = true;
        }
    }
    used
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::input::tests::one_scan;
    use crate::model::scan::Measurement;
    use crate::model::sensing::MeasurementModel;
    use crate::model::sensor::Sensor;

    /// One scan of a sensor with a field of view of 1 000 m², and `count` detections that no track takes.
    fn warnings(count: usize, clutter_per_m2: Option<f64>) -> Vec<String> {
        let max_range_m = Some((1000.0 / std::f64::consts::PI).sqrt());
        let settings = SensorSettings {
            max_range_m,
            clutter_per_m2,
            ..SensorSettings::named("radar")
        };
        let place = |index: usize| Measurement::Position {
            x_m: index as f64,
            y_m: 0.0,
        };
        let places: Vec<Measurement> = (0..count).map(place).collect();
        let recording = one_scan(settings.clone(), &places);
        let report = MeasurementModel::Position {
            sigma_x_m: 1.0,
            sigma_y_m: 1.0,
        };
        let sensor = Sensor {
            sensor_id: "radar".into(),
            p_d: 0.9,
            clutter_density: clutter_per_m2.unwrap_or(1e3),
            may_start: true,
            report,
        };
        let data = ResolvedRecording {
            recording: &recording,
            known: &[settings],
            sensors: &[sensor],
        };
        disagreements(&data, &TrackSet::default())
    }

    #[test]
    fn a_density_within_a_factor_of_three_is_not_mentioned() {
        assert_eq!(warnings(20, Some(0.02)), Vec::<String>::new());
        assert_eq!(warnings(59, Some(0.02)), Vec::<String>::new());
        assert_eq!(
            warnings(9, Some(1e-6)),
            Vec::<String>::new(),
            "nine detections are too few to tell"
        );
    }

    #[test]
    fn one_that_was_estimated_is_not_compared() {
        assert_eq!(warnings(61, None), Vec::<String>::new());
    }

    #[test]
    fn one_that_is_further_off_is_named_with_the_estimate() {
        let high = warnings(61, Some(0.02));
        assert!(
            high.len() == 1 && high[0].contains("6.100e-2 per m²"),
            "{high:?}"
        );
        let low = warnings(6, Some(0.02));
        assert!(
            low.len() == 1 && low[0].contains("6.000e-3 per m²"),
            "{low:?}"
        );
    }
}
