//! The sensors of a recording, completed: what the request says, else what came with the data, else what can soundly
//! be estimated from the data, said in a warning; what cannot be estimated is a fault.

use super::extent::{Extent, detections_of, place_of};
use crate::filtering::AnyFilter;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording};
use crate::model::sensor::{MeasurementModel, Polar, RangeRate, Sensor, SensorSettings};
use crate::model::state::Position;

/// Assumed when nobody says how often a target is detected.
const ASSUMED_P_D: f64 = 0.9;
/// No scene is so clean that a false detection is impossible; keeps likelihood ratios finite. Per m² or per degree.
const LEAST_CLUTTER: f64 = 1e-15;

/// What is known of each sensor of the recording, request over upload over data.
///
/// # Errors
/// A fault for each setting of a sensor that the recording does not have.
pub(super) fn known(
    recording: &Recording,
    uploaded: &[SensorSettings],
    requested: &[SensorSettings],
) -> Result<Vec<SensorSettings>, Vec<Fault>> {
    let names: Vec<&str> = recording
        .sensors
        .iter()
        .map(|sensor| sensor.sensor_id.as_str())
        .collect();
    let is_unknown =
        |(_, settings): &(usize, &SensorSettings)| !names.contains(&settings.sensor_id.as_str());
    let fault = |(index, settings): (usize, &SensorSettings)| {
        let detail = format!("the recording has no sensor '{}'", settings.sensor_id);
        Fault::new(
            format!("/sensors/{index}/sensor_id"),
            "unknown_value",
            detail,
        )
        .allowing(names.join(", "))
    };
    let faults: Vec<Fault> = requested
        .iter()
        .enumerate()
        .filter(is_unknown)
        .map(fault)
        .collect();
    if !faults.is_empty() {
        return Err(faults);
    }
    let complete = |sensor: &SensorSettings| {
        let of_this = |list: &[SensorSettings]| {
            list.iter()
                .find(|other| other.sensor_id == sensor.sensor_id)
                .cloned()
                .unwrap_or_default()
        };
        sensor
            .overridden_by(&of_this(uploaded))
            .overridden_by(&of_this(requested))
    };
    Ok(recording.sensors.iter().map(complete).collect())
}

/// Sensors that a tracker with the given filter (and its name) can work with.
///
/// # Errors
/// All faults: noise that nobody knows, reports that the filter cannot use.
pub(super) fn resolve(
    recording: &Recording,
    known: &[SensorSettings],
    filter: (&AnyFilter, &str),
    warnings: &mut Vec<String>,
) -> Result<Vec<Sensor>, Vec<Fault>> {
    let mut faults = Vec::new();
    let uses_rates = uses_range_rates(recording, filter, warnings);
    let mut sensors = Vec::with_capacity(known.len());
    for (index, settings) in known.iter().enumerate() {
        let Some(kind) = usable_kind(recording, index, settings, filter, &mut faults) else {
            continue;
        };
        if kind == Kind::Bearing
            && detections_of(recording, index)
                .any(|detection| matches!(detection.measurement, Measurement::RangeBearing { .. }))
        {
            warnings.push(format!(
                "sensor '{}': its ranges are not used",
                settings.sensor_id
            ));
        }
        let mut reader = NoiseReader {
            settings,
            faults: &mut faults,
        };
        let report = match kind {
            Kind::Position => MeasurementModel::Position {
                sigma_x_m: reader.required("sigma_x_m", settings.sigma_x_m, "m"),
                sigma_y_m: reader.required("sigma_y_m", settings.sigma_y_m, "m"),
            },
            Kind::Polar => MeasurementModel::Polar(Polar {
                place_m: place(settings, warnings),
                sigma_range_m: reader.required("sigma_range_m", settings.sigma_range_m, "m"),
                sigma_bearing_rad: reader
                    .required("sigma_bearing_deg", settings.sigma_bearing_deg, "deg")
                    .to_radians(),
                range_rate: uses_rates.then(|| RangeRate {
                    sigma_mps: reader.required(
                        "sigma_range_rate_mps",
                        settings.sigma_range_rate_mps,
                        "m/s",
                    ),
                    span_mps: range_rate_span_mps(recording, index),
                }),
            }),
            Kind::Bearing => MeasurementModel::Bearing {
                sigma_bearing_rad: reader
                    .required("sigma_bearing_deg", settings.sigma_bearing_deg, "deg")
                    .to_radians(),
            },
        };
        sensors.push(complete(recording, index, settings, report, warnings));
    }
    if filter.0.is_of_bearings() {
        faults.extend(two_places(known));
    }
    if faults.is_empty() {
        Ok(sensors)
    } else {
        Err(faults)
    }
}

/// A fault for each density that the request states over a space in which the sensor's reports do not lie.
pub(super) fn misplaced_densities(requested: &[SensorSettings], sensors: &[Sensor]) -> Vec<Fault> {
    let fault = |(index, settings): (usize, &SensorSettings)| {
        let sensor = sensors
            .iter()
            .find(|sensor| sensor.sensor_id == settings.sensor_id)?;
        let (given, wanted) = misplaced_density(
            settings,
            matches!(sensor.report, MeasurementModel::Bearing { .. }),
        )?;
        let detail = format!(
            "the clutter of sensor '{}' is stated in '{given}'; what is used of its reports needs '{wanted}'",
            sensor.sensor_id
        );
        Some(
            Fault::new(format!("/sensors/{index}/{given}"), "unsupported", detail).allowing(wanted),
        )
    };
    requested.iter().enumerate().filter_map(fault).collect()
}

/// The density that is given and the one that is wanted instead. A sensor that has both is described for either use.
fn misplaced_density(
    settings: &SensorSettings,
    is_of_bearings: bool,
) -> Option<(&'static str, &'static str)> {
    match (settings.clutter_per_m2, settings.clutter_per_deg) {
        (Some(_), None) if is_of_bearings => Some(("clutter_per_m2", "clutter_per_deg")),
        (None, Some(_)) if !is_of_bearings => Some(("clutter_per_deg", "clutter_per_m2")),
        _ => None,
    }
}

/// Bearings from two places are not one track.
fn two_places(known: &[SensorSettings]) -> Option<Fault> {
    let (first, rest) = known.split_first()?;
    let other = rest
        .iter()
        .find(|other| place_of(other) != place_of(first))?;
    let detail = format!(
        "bearings from two places are not one track: sensors '{}' and '{}' stand apart",
        first.sensor_id, other.sensor_id
    );
    Some(
        Fault::new("/input/sensor_ids", "unsupported", detail)
            .allowing("sensors that stand at one place"),
    )
}

/// What of a sensor's reports is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Position,
    Polar,
    Bearing,
}

/// What the sensor reports, if the filter can use it.
fn usable_kind(
    recording: &Recording,
    index: usize,
    settings: &SensorSettings,
    (filter, filter_name): (&AnyFilter, &str),
    faults: &mut Vec<Fault>,
) -> Option<Kind> {
    let has = |wanted: fn(&Measurement) -> bool| {
        detections_of(recording, index).any(|detection| wanted(&detection.measurement))
    };
    let positions = has(|measurement| matches!(measurement, Measurement::Position { .. }));
    let ranges = has(|measurement| matches!(measurement, Measurement::RangeBearing { .. }));
    let bearings = has(|measurement| matches!(measurement, Measurement::Bearing { .. }));
    let name = &settings.sensor_id;
    let usable = match filter {
        AnyFilter::Kalman(_) => "positions (x_m, y_m)",
        AnyFilter::BearingOnly(_) => "bearings (bearing_deg), with or without ranges (range_m)",
        _ => "positions (x_m, y_m); ranges and bearings (range_m, bearing_deg)",
    };
    let mut refuse = |what: &str| {
        let others = if recording.sensors.len() > 1 {
            "; 'sensor_ids' of the input can leave it out"
        } else {
            ""
        };
        let detail = format!(
            "sensor '{name}' reports {what}, which the filter '{filter_name}' cannot use{others}"
        );
        faults.push(Fault::new("/filter/method", "unsupported", detail).allowing(usable));
        None
    };
    match (positions, ranges, bearings) {
        (true, ..) if filter.is_of_bearings() => refuse("positions"),
        _ if filter.is_of_bearings() => Some(Kind::Bearing),
        (_, _, true) => refuse("bearings without ranges"),
        (true, true, _) => refuse("positions in some detections and ranges in others"),
        (false, true, _) if !filter.uses_ranges() => refuse("ranges and bearings"),
        (false, true, _) => Some(Kind::Polar),
        // A sensor that never reported anything is what its settings say.
        (false, false, _) if settings.sigma_range_m.is_some() && filter.uses_ranges() => {
            Some(Kind::Polar)
        }
        _ => Some(Kind::Position),
    }
}

/// Takes noises from the settings; those that are missing become faults.
struct NoiseReader<'a> {
    settings: &'a SensorSettings,
    faults: &'a mut Vec<Fault>,
}

impl NoiseReader<'_> {
    fn required(&mut self, field: &str, value: Option<f64>, unit: &str) -> f64 {
        if value.is_none() {
            let detail = format!(
                "the noise of sensor '{}' is not known: give '{field}' in 'sensors'",
                self.settings.sensor_id
            );
            self.faults
                .push(Fault::new("/sensors", "missing", detail).allowing(format!("> 0 {unit}")));
        }
        value.unwrap_or(1.0)
    }
}

fn place(settings: &SensorSettings, warnings: &mut Vec<String>) -> Position {
    if settings.x_m.is_none() || settings.y_m.is_none() {
        warnings.push(format!(
            "sensor '{}': its position is not known; missing x_m or y_m are taken to be 0",
            settings.sensor_id
        ));
    }
    place_of(settings)
}

/// Range rates are used by a filter that can, when every detection of the recording has one.
fn uses_range_rates(
    recording: &Recording,
    (filter, filter_name): (&AnyFilter, &str),
    warnings: &mut Vec<String>,
) -> bool {
    let has_rate = |detection: &&Detection| {
        matches!(
            detection.measurement,
            Measurement::RangeBearing {
                range_rate_mps: Some(_),
                ..
            }
        )
    };
    let with_rate = recording.detections.iter().filter(has_rate).count();
    if with_rate == 0 {
        return false;
    }
    let (all, is_able) = (
        with_rate == recording.detections.len(),
        filter.uses_range_rates(),
    );
    if !is_able {
        warnings.push(format!(
            "range rates are not used: the filter '{filter_name}' does not know them"
        ));
    } else if !all {
        warnings.push(format!(
            "range rates are not used: {with_rate} of {} detections have one",
            recording.detections.len()
        ));
    }
    all && is_able
}

/// The interval over which a sensor's range rates reach; at least 1 m/s, so that a density over it exists.
fn range_rate_span_mps(recording: &Recording, sensor: usize) -> f64 {
    let rates = || {
        detections_of(recording, sensor).filter_map(|detection| match detection.measurement {
            Measurement::RangeBearing { range_rate_mps, .. } => range_rate_mps,
            _ => None,
        })
    };
    (rates().fold(f64::NEG_INFINITY, f64::max) - rates().fold(f64::INFINITY, f64::min)).max(1.0)
}

fn complete(
    recording: &Recording,
    index: usize,
    settings: &SensorSettings,
    report: MeasurementModel,
    warnings: &mut Vec<String>,
) -> Sensor {
    let name = &settings.sensor_id;
    let p_d = settings.p_d.unwrap_or_else(|| {
        warnings.push(format!(
            "sensor '{name}': the detection probability is not known; {ASSUMED_P_D} is assumed"
        ));
        ASSUMED_P_D
    });
    let extent = Extent::of(recording, index, settings, &report);
    let density = extent.density_of(settings).unwrap_or_else(|| {
        let density = estimated_clutter(recording, index, &extent);
        let unknown = misplaced_density(settings, extent.is_of_bearings).map_or(
            "the clutter density is not known".to_owned(),
            |(given, wanted)| format!("'{given}' is not used, '{wanted}' is not known"),
        );
        warnings.push(format!(
            "sensor '{name}': {unknown}; {density:.3e} per {} is estimated from the data",
            extent.unit()
        ));
        density
    });
    Sensor {
        sensor_id: name.clone(),
        p_d,
        clutter_density: extent.inside(density.max(LEAST_CLUTTER)),
        report,
    }
}

/// Detections a scan over the extent of them all: an upper bound, since targets are among them.
fn estimated_clutter(recording: &Recording, sensor: usize, extent: &Extent) -> f64 {
    let scans = || recording.scans.iter().filter(|scan| scan.sensor == sensor);
    let detections: usize = scans().map(|scan| scan.count).sum();
    if detections < 2 || extent.seen <= 0.0 {
        LEAST_CLUTTER
    } else {
        detections as f64 / scans().count() as f64 / extent.seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filtering::bearing_only::BearingOnly;
    use crate::filtering::extended::Extended;
    use crate::filtering::kalman::Kalman;
    use crate::model::scan::{RecordingParts, Scan};

    fn recording(measurements: &[Measurement]) -> Recording {
        let detections: Vec<Detection> = measurements
            .iter()
            .map(|&measurement| Detection {
                measurement,
                origin: None,
                amplitude: None,
            })
            .collect();
        Recording::new(RecordingParts {
            sensors: vec![SensorSettings::named("radar")],
            scans: vec![Scan {
                number: 1,
                time_s: 0.0,
                sensor: 0,
                first: 0,
                count: detections.len(),
            }],
            detection_ids: (0..detections.len())
                .map(|index| index.to_string())
                .collect(),
            detections,
            ..Default::default()
        })
        .unwrap()
    }

    const KALMAN: (&AnyFilter, &str) = (
        &AnyFilter::Kalman(Kalman {
            process_noise_m2ps3: 1.0,
        }),
        "kalman",
    );
    const EXTENDED: (&AnyFilter, &str) = (
        &AnyFilter::Extended(Extended {
            process_noise_m2ps3: 1.0,
        }),
        "extended",
    );

    const BEARING_ONLY: (&AnyFilter, &str) = (
        &AnyFilter::BearingOnly(BearingOnly {
            process_noise_rad2ps3: 1e-6,
            initial_rate_sigma_radps: 0.1,
        }),
        "bearing_only",
    );

    fn polar(range_m: f64, range_rate_mps: Option<f64>) -> Measurement {
        Measurement::RangeBearing {
            range_m,
            bearing_rad: 1.0,
            range_rate_mps,
        }
    }

    fn at(x_m: f64, y_m: f64) -> Measurement {
        Measurement::Position { x_m, y_m }
    }

    #[test]
    fn the_request_wins_over_the_upload_and_the_rest_is_estimated_with_a_warning() {
        let recording = recording(&[at(0.0, 0.0), at(10.0, 20.0), at(5.0, 5.0), at(1.0, 1.0)]);
        let uploaded = [SensorSettings {
            sigma_x_m: Some(1.0),
            sigma_y_m: Some(2.0),
            ..SensorSettings::named("radar")
        }];
        let requested = [SensorSettings {
            sigma_x_m: Some(3.0),
            ..SensorSettings::named("radar")
        }];
        let mut warnings = Vec::new();
        let known = known(&recording, &uploaded, &requested).unwrap();
        let sensors = resolve(&recording, &known, KALMAN, &mut warnings).unwrap();
        let report = MeasurementModel::Position {
            sigma_x_m: 3.0,
            sigma_y_m: 2.0,
        };
        let expected = Sensor {
            sensor_id: "radar".into(),
            p_d: 0.9,
            clutter_density: 0.02,
            report,
        };
        assert_eq!(sensors, [expected]);
        assert_eq!(warnings.len(), 2);
    }

    #[test]
    fn unknown_noise_unknown_sensors_and_unusable_reports_are_faults() {
        let seen =
            |measurement: Measurement, filter: (&AnyFilter, &str)| -> Vec<(String, String)> {
                let recording = recording(&[measurement]);
                let known = known(&recording, &[], &[]).unwrap();
                let faults = resolve(&recording, &known, filter, &mut Vec::new()).unwrap_err();
                faults
                    .into_iter()
                    .map(|fault| (fault.pointer, fault.detail))
                    .collect()
            };
        let unknown = known(
            &recording(&[at(0.0, 0.0)]),
            &[],
            &[SensorSettings::named("sonar")],
        )
        .unwrap_err();
        assert_eq!(
            (unknown[0].pointer.as_str(), unknown[0].allowed.as_deref()),
            ("/sensors/0/sensor_id", Some("radar"))
        );
        let named = |faults: &[(String, String)], pointer: &str, words: &[&str]| {
            assert_eq!(faults.len(), words.len(), "{faults:?}");
            assert!(
                faults
                    .iter()
                    .zip(words)
                    .all(|(fault, word)| fault.0 == pointer && fault.1.contains(word)),
                "{faults:?}"
            );
        };
        named(
            &seen(at(0.0, 0.0), KALMAN),
            "/sensors",
            &["'sigma_x_m'", "'sigma_y_m'"],
        );
        named(
            &seen(polar(9.0, None), KALMAN),
            "/filter/method",
            &["sensor 'radar' reports ranges and bearings, which the filter 'kalman'"],
        );
        named(
            &seen(polar(9.0, None), EXTENDED),
            "/sensors",
            &["'sigma_range_m'", "'sigma_bearing_deg'"],
        );
        named(
            &seen(polar(9.0, Some(1.0)), EXTENDED),
            "/sensors",
            &[
                "'sigma_range_m'",
                "'sigma_bearing_deg'",
                "'sigma_range_rate_mps'",
            ],
        );
        named(
            &seen(Measurement::Bearing { bearing_rad: 1.0 }, EXTENDED),
            "/filter/method",
            &["bearings without ranges"],
        );
        named(
            &seen(Measurement::Bearing { bearing_rad: 1.0 }, KALMAN),
            "/filter/method",
            &["bearings without ranges"],
        );
        named(
            &seen(at(0.0, 0.0), BEARING_ONLY),
            "/filter/method",
            &["reports positions, which the filter 'bearing_only'"],
        );
        named(
            &seen(Measurement::Bearing { bearing_rad: 1.0 }, BEARING_ONLY),
            "/sensors",
            &["'sigma_bearing_deg'"],
        );
    }

    #[test]
    fn a_polar_sensor_takes_its_noise_in_degrees_and_its_range_rates_only_when_all_have_one() {
        let settings = SensorSettings {
            sigma_range_m: Some(15.0),
            sigma_bearing_deg: Some(90.0),
            sigma_range_rate_mps: Some(0.5),
            clutter_per_m2: Some(1e-6),
            p_d: Some(0.8),
            ..SensorSettings::named("radar")
        };
        let resolved = |measurements: &[Measurement]| {
            let mut warnings = Vec::new();
            let sensors = resolve(
                &recording(measurements),
                std::slice::from_ref(&settings),
                EXTENDED,
                &mut warnings,
            )
            .unwrap();
            (sensors[0].report, warnings)
        };
        let expected = Polar {
            place_m: Position::zeros(),
            sigma_range_m: 15.0,
            sigma_bearing_rad: std::f64::consts::FRAC_PI_2,
            range_rate: Some(RangeRate {
                sigma_mps: 0.5,
                span_mps: 30.0,
            }),
        };
        let (report, warnings) = resolved(&[polar(10.0, Some(-10.0)), polar(20.0, Some(20.0))]);
        assert_eq!(report, MeasurementModel::Polar(expected));
        assert!(
            warnings.len() == 1 && warnings[0].contains("position is not known"),
            "{warnings:?}"
        );
        let (report, warnings) = resolved(&[polar(10.0, Some(-10.0)), polar(20.0, None)]);
        assert_eq!(
            report,
            MeasurementModel::Polar(Polar {
                range_rate: None,
                ..expected
            })
        );
        assert!(
            warnings[0].contains("1 of 2 detections have one"),
            "{warnings:?}"
        );
    }

    #[test]
    fn a_bearing_sensor_takes_its_clutter_per_degree_and_ranges_are_left_out_with_a_warning() {
        let settings = SensorSettings {
            sigma_bearing_deg: Some(1.0),
            p_d: Some(0.8),
            ..SensorSettings::named("radar")
        };
        let resolved = |measurements: &[Measurement], clutter_per_deg: Option<f64>| {
            let (settings, mut warnings) = (
                SensorSettings {
                    clutter_per_deg,
                    ..settings.clone()
                },
                Vec::new(),
            );
            let sensors = resolve(
                &recording(measurements),
                &[settings],
                BEARING_ONLY,
                &mut warnings,
            )
            .unwrap();
            assert_eq!(
                sensors[0].report,
                MeasurementModel::Bearing {
                    sigma_bearing_rad: 1f64.to_radians()
                }
            );
            (sensors[0].clutter_density.to_radians(), warnings)
        };
        let bearing = |degrees: f64| Measurement::Bearing {
            bearing_rad: degrees.to_radians(),
        };
        let (per_deg, warnings) = resolved(&[bearing(350.0), bearing(10.0)], Some(0.02));
        assert!(
            (per_deg - 0.02).abs() < 1e-12 && warnings.is_empty(),
            "{warnings:?}"
        );
        let (per_deg, warnings) = resolved(&[bearing(350.0), bearing(10.0)], None);
        assert!(
            (per_deg - 0.1).abs() < 1e-9,
            "two detections in one scan of 20 degrees: {per_deg}"
        );
        assert!(
            warnings.len() == 1 && warnings[0].contains("1.000e-1 per degree is estimated"),
            "{warnings:?}"
        );
        let (_, warnings) = resolved(&[polar(9.0, None)], Some(0.02));
        assert_eq!(warnings, ["sensor 'radar': its ranges are not used"]);
    }

    #[test]
    fn a_density_over_the_wrong_space_is_named() {
        let per_m2 = SensorSettings {
            clutter_per_m2: Some(1e-6),
            ..SensorSettings::named("radar")
        };
        let per_deg = SensorSettings {
            clutter_per_deg: Some(0.1),
            ..SensorSettings::named("radar")
        };
        let both = SensorSettings {
            clutter_per_m2: Some(1e-6),
            ..per_deg.clone()
        };
        let sensor = |report| {
            [Sensor {
                sensor_id: "radar".into(),
                p_d: 0.9,
                clutter_density: 1.0,
                report,
            }]
        };
        let of_bearings = sensor(MeasurementModel::Bearing {
            sigma_bearing_rad: 0.1,
        });
        let of_places = sensor(MeasurementModel::Position {
            sigma_x_m: 1.0,
            sigma_y_m: 1.0,
        });
        let found = |settings: &SensorSettings, sensors: &[Sensor]| {
            let faults =
                misplaced_densities(&[SensorSettings::named("other"), settings.clone()], sensors);
            faults
                .into_iter()
                .map(|fault| (fault.pointer, fault.allowed.unwrap()))
                .collect::<Vec<_>>()
        };
        assert_eq!(
            found(&per_m2, &of_bearings),
            [(
                "/sensors/1/clutter_per_m2".to_owned(),
                "clutter_per_deg".to_owned()
            )]
        );
        assert_eq!(
            found(&per_deg, &of_places),
            [(
                "/sensors/1/clutter_per_deg".to_owned(),
                "clutter_per_m2".to_owned()
            )]
        );
        assert_eq!(
            [found(&per_m2, &of_places), found(&per_deg, &of_bearings)],
            [[], []]
        );
        assert_eq!(
            [found(&both, &of_places), found(&both, &of_bearings)],
            [[], []]
        );

        // What came with the data is not the request's fault, so that it becomes a warning.
        let uploaded = SensorSettings {
            sigma_bearing_deg: Some(1.0),
            p_d: Some(0.8),
            ..per_m2
        };
        let mut warnings = Vec::new();
        let seen = recording(&[
            Measurement::Bearing { bearing_rad: 0.0 },
            Measurement::Bearing { bearing_rad: 0.1 },
        ]);
        resolve(&seen, &[uploaded], BEARING_ONLY, &mut warnings).unwrap();
        assert!(
            warnings.len() == 1
                && warnings[0]
                    .contains("'clutter_per_m2' is not used, 'clutter_per_deg' is not known"),
            "{warnings:?}"
        );
    }

    #[test]
    fn bearings_from_two_places_are_refused() {
        let settings = |name: &str, x_m: f64| SensorSettings {
            sigma_bearing_deg: Some(1.0),
            x_m: Some(x_m),
            ..SensorSettings::named(name)
        };
        let parts = RecordingParts {
            sensors: vec![SensorSettings::named("a"), SensorSettings::named("b")],
            ..Default::default()
        };
        let recording = Recording::new(parts).unwrap();
        let faults = |b_x_m: f64| {
            resolve(
                &recording,
                &[settings("a", 0.0), settings("b", b_x_m)],
                BEARING_ONLY,
                &mut Vec::new(),
            )
            .err()
        };
        assert_eq!(faults(0.0), None);
        let found = faults(5.0).unwrap();
        assert_eq!(
            (found.len(), found[0].pointer.as_str()),
            (1, "/input/sensor_ids")
        );
        assert!(
            found[0].detail.contains("sensors 'a' and 'b' stand apart"),
            "{found:?}"
        );
    }
}
