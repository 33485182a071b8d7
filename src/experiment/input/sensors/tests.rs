//! Sensors that are told, assumed, estimated and refused.

use super::*;
use crate::filtering::bearing_only::BearingOnly;
use crate::filtering::motions::AnyMotion;
use crate::filtering::{AnyFilter, Movement, PlaceFilter, Reports, Way};
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::model::scan::{Detection, RecordingParts, Scan};

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
            pose: None,
            own: Vec::new(),
            detections,
        }],
        detection_ids: (0..measurements.len())
            .map(|index| index.to_string())
            .collect(),
        ..Default::default()
    })
    .unwrap()
}

const KALMAN: NamedFilter = named("kalman", Reports::Positions);
const EXTENDED: NamedFilter = named("extended", Reports::All);

const fn named(name: &'static str, reports: Reports) -> NamedFilter {
    let calm = ConstantVelocity {
        spectral_density: 1.0,
    };
    NamedFilter {
        filter: AnyFilter::Plane(PlaceFilter {
            movement: Movement::Single(AnyMotion::ConstantVelocity(calm)),
            way: Way::Line,
            reports,
            vertical: calm,
        }),
        name,
    }
}

const BEARING_ONLY: NamedFilter = NamedFilter {
    filter: AnyFilter::Bearing(BearingOnly {
        process_noise_rad2ps3: 1e-6,
        initial_rate_sigma_radps: 0.1,
    }),
    name: "bearing_only",
};

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
    let known = merge_settings(&recording, &uploaded, &requested).unwrap();
    let sensors = resolve(&recording, &known, &KALMAN, &mut warnings).unwrap();
    let report = MeasurementModel::Position {
        sigma_x_m: 3.0,
        sigma_y_m: 2.0,
    };
    let expected = Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density: 0.02,
        may_start: true,
        report,
        sight: None,
    };
    assert_eq!(sensors, [expected]);
    assert_eq!(warnings.len(), 2);
}

#[test]
fn settings_of_a_sensor_that_is_not_there_are_a_fault() {
    let sonar = [SensorSettings::named("sonar")];
    let unknown = merge_settings(&recording(&[at(0.0, 0.0)]), &[], &sonar).unwrap_err();
    assert_eq!(
        (unknown[0].pointer.as_str(), unknown[0].allowed.as_deref()),
        ("/sensors/0/sensor_id", Some("radar"))
    );
}

/// The faults of one detection with a filter: all at one pointer, each with its words.
fn assert_refused(measurement: Measurement, filter: &NamedFilter, pointer: &str, words: &[&str]) {
    let recording = recording(&[measurement]);
    let known = merge_settings(&recording, &[], &[]).unwrap();
    let faults = resolve(&recording, &known, filter, &mut Vec::new()).unwrap_err();
    assert_eq!(faults.len(), words.len(), "{faults:?}");
    for (fault, word) in faults.iter().zip(words) {
        assert!(
            fault.pointer == pointer && fault.detail.contains(word),
            "{faults:?}"
        );
    }
}

#[test]
fn unknown_noise_is_a_fault() {
    let noises = ["'sigma_range_m'", "'sigma_bearing_deg'"];
    let all_noises = [noises[0], noises[1], "'sigma_range_rate_mps'"];
    assert_refused(
        at(0.0, 0.0),
        &KALMAN,
        "/sensors",
        &["'sigma_x_m'", "'sigma_y_m'"],
    );
    assert_refused(polar(9.0, None), &EXTENDED, "/sensors", &noises);
    assert_refused(polar(9.0, Some(1.0)), &EXTENDED, "/sensors", &all_noises);
    let bearing = Measurement::Bearing { bearing_rad: 1.0 };
    assert_refused(bearing, &BEARING_ONLY, "/sensors", &noises[1..]);
}

#[test]
fn unusable_reports_are_faults() {
    let pointer = "/filter/method";
    let of_ranges = ["sensor 'radar' reports ranges and bearings, which the filter 'kalman'"];
    assert_refused(polar(9.0, None), &KALMAN, pointer, &of_ranges);
    let bearing = Measurement::Bearing { bearing_rad: 1.0 };
    for filter in [&EXTENDED, &KALMAN] {
        assert_refused(bearing, filter, pointer, &["bearings without ranges"]);
    }
    let of_positions = ["reports positions, which the filter 'bearing_only'"];
    assert_refused(at(0.0, 0.0), &BEARING_ONLY, pointer, &of_positions);
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
            &EXTENDED,
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
        platform: Platform::STANDING,
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
            &BEARING_ONLY,
            &mut warnings,
        )
        .unwrap();
        assert_eq!(
            sensors[0].report,
            MeasurementModel::Bearing(Bearing {
                place_m: Position::zeros(),
                sigma_bearing_rad: 1f64.to_radians(),
                platform: Platform::STANDING,
                range_prior: None,
            })
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

fn with_densities(per_m2: Option<f64>, per_deg: Option<f64>) -> SensorSettings {
    SensorSettings {
        clutter_per_m2: per_m2,
        clutter_per_deg: per_deg,
        ..SensorSettings::named("radar")
    }
}

/// The field with a density of the wrong space, and the one that is wanted.
fn misplaced(settings: &SensorSettings, report: MeasurementModel) -> Vec<(String, String)> {
    let sensor = Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density: 1.0,
        may_start: true,
        report,
        sight: None,
    };
    let requested = [SensorSettings::named("other"), settings.clone()];
    misplaced_densities(&requested, &[sensor])
        .into_iter()
        .map(|fault| (fault.pointer, String::from(fault.allowed.unwrap())))
        .collect()
}

#[test]
fn a_density_over_the_wrong_space_is_named() {
    let of_bearings = MeasurementModel::Bearing(Bearing {
        place_m: Position::zeros(),
        sigma_bearing_rad: 0.1,
        platform: Platform::STANDING,
        range_prior: None,
    });
    let of_places = MeasurementModel::Position {
        sigma_x_m: 1.0,
        sigma_y_m: 1.0,
    };
    let per_m2 = with_densities(Some(1e-6), None);
    let per_deg = with_densities(None, Some(0.1));
    let both = with_densities(Some(1e-6), Some(0.1));
    let wrong = |given: &str, wanted: &str| [(format!("/sensors/1/{given}"), wanted.to_owned())];
    assert_eq!(
        misplaced(&per_m2, of_bearings),
        wrong("clutter_per_m2", "clutter_per_deg")
    );
    assert_eq!(
        misplaced(&per_deg, of_places),
        wrong("clutter_per_deg", "clutter_per_m2")
    );
    for (settings, report) in [
        (&per_m2, of_places),
        (&per_deg, of_bearings),
        (&both, of_places),
        (&both, of_bearings),
    ] {
        assert_eq!(misplaced(settings, report), []);
    }
}

#[test]
fn an_uploaded_density_over_the_wrong_space_is_a_warning() {
    let uploaded = SensorSettings {
        sigma_bearing_deg: Some(1.0),
        p_d: Some(0.8),
        ..with_densities(Some(1e-6), None)
    };
    let mut warnings = Vec::new();
    let seen = recording(&[
        Measurement::Bearing { bearing_rad: 0.0 },
        Measurement::Bearing { bearing_rad: 0.1 },
    ]);
    resolve(&seen, &[uploaded], &BEARING_ONLY, &mut warnings).unwrap();
    assert!(
        warnings.len() == 1
            && warnings[0].contains("'clutter_per_m2' is not used, 'clutter_per_deg' is not known"),
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
            &BEARING_ONLY,
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

/// Reports 100 m to 900 m high, of a radar of space.
fn of_space(settings: &SensorSettings) -> (Sensor, Vec<String>) {
    let seen = |elevation_deg: f64, bearing_rad: f64| Measurement::RangeBearingElevation {
        range_m: 1000.0,
        bearing_rad,
        elevation_rad: elevation_deg.to_radians(),
        range_rate_mps: None,
    };
    let recording = recording(&[seen(30.0, 0.0), seen(-30.0, 1.0), seen(10.0, 3.0)]);
    let known = SensorSettings {
        x_m: Some(5.0),
        y_m: Some(6.0),
        z_m: Some(7.0),
        p_d: Some(0.9),
        sigma_range_m: Some(10.0),
        sigma_bearing_deg: Some(0.5),
        ..SensorSettings::named("radar")
    };
    let (known, mut warnings) = ([known.overridden_by(settings)], Vec::new());
    let filter = EXTENDED.within(Space::Volume);
    let sensors = resolve(&recording, &known, &filter, &mut warnings).unwrap();
    (sensors[0].clone(), warnings)
}

fn spherical(sensor: &Sensor) -> crate::model::sensing::Spherical {
    match sensor.report {
        MeasurementModel::Spherical(spherical) => spherical,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_radar_of_space_has_a_site_and_says_over_what_its_clutter_is_stated() {
    let sigma_elevation_deg = Some(0.25);
    let per_m3 = SensorSettings {
        clutter_per_m3: Some(1e-9),
        sigma_elevation_deg,
        ..SensorSettings::named("radar")
    };
    let (sensor, warnings) = of_space(&per_m3);
    let told = spherical(&sensor);
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!((sensor.clutter_density, told.clutter_span), (1e-9, None));
    assert_eq!(
        told.site.place_m,
        crate::model::space::Place::new(5.0, 6.0, 7.0)
    );
    assert_eq!(told.sigma_elevation_rad, Some(0.25f64.to_radians()));
    assert!(sensor.may_start);
    // Per m² of ground it is spread over the 1 000 m between 30 degrees down and up.
    let per_m2 = SensorSettings {
        clutter_per_m2: Some(1e-6),
        sigma_elevation_deg,
        ..SensorSettings::named("radar")
    };
    let (sensor, _) = of_space(&per_m2);
    let span_m = spherical(&sensor).clutter_span.unwrap();
    assert!((span_m - 1000.0).abs() < 1e-9, "{span_m}");
    assert_eq!(sensor.clutter_density, 1e-6);
}

#[test]
fn what_nobody_says_of_a_radar_of_space_is_assumed_with_a_warning() {
    let (sensor, warnings) = of_space(&SensorSettings::named("radar"));
    assert_eq!(
        spherical(&sensor).sigma_elevation_rad,
        Some(0.5f64.to_radians())
    );
    let [elevations, clutter] = warnings.as_slice() else {
        panic!("{warnings:?}")
    };
    assert!(
        elevations.contains("that of its bearings, 0.5 deg, is assumed"),
        "{elevations}"
    );
    assert!(
        clutter.contains("per m³ is estimated from the data"),
        "{clutter}"
    );
}

#[test]
fn densities_of_space_are_none_of_the_plane() {
    let per_m3 = SensorSettings {
        clutter_per_m3: Some(1e-9),
        ..SensorSettings::named("radar")
    };
    let of_places = MeasurementModel::Position {
        sigma_x_m: 1.0,
        sigma_y_m: 1.0,
    };
    let found = misplaced(&per_m3, of_places);
    assert_eq!(
        found,
        [(
            "/sensors/1/clutter_per_m3".to_owned(),
            "clutter_per_m2".to_owned()
        )]
    );
}
