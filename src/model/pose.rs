//! Where a sensor is at a scan, how it moves, how it is turned, and how well that is known.
//!
//! # Symbols
//! ψ, θ, φ heading, pitch and roll; b, ε bearing and elevation in the body; λ bearing from the bow in the level plane.
//!
//! # Method
//! Axes of the body point forward, to starboard and down. North, east and down are Rz(ψ) Ry(θ) Rx(φ) of the body's axes, the order
//! of aerospace: heading clockwise from north, bow up, starboard side down. A target at the height of the sensor is seen in the body
//! at tan ε = (sin b sin φ cos θ − cos b sin θ) / (cos φ cos θ), and lies at λ = atan2(sin b / cos φ − cos b tan θ tan φ, cos b / cos θ).

use super::angle::wrap;
use super::space::Place;
use nalgebra::{Matrix3, Vector3};

/// Of one sensor at one scan. What is not known is 0.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pose {
    /// East, north, up (m).
    pub place: Place,
    /// East, north, up (m/s). 0 where range rates are over ground already.
    pub velocity: Place,
    /// Needed to turn relative bearings.
    pub attitude: Option<Attitude>,
    pub sigmas: PoseSigmas,
}

/// Standard deviations of a pose: independent, and 0 for what is certain.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PoseSigmas {
    /// East, north, up (m).
    pub place: Place,
    /// East, north, up (m/s).
    pub velocity: Place,
    pub heading_rad: f64,
    pub pitch_rad: f64,
    pub roll_rad: f64,
}

/// How a body is turned.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Attitude {
    /// Clockwise from north.
    pub heading_rad: f64,
    /// Bow up; between −90° and 90°.
    pub pitch_rad: f64,
    /// Starboard side down; between −90° and 90°.
    pub roll_rad: f64,
}

impl Pose {
    /// What its values are called on the wire; in files `sensor_` stands before them. Angles are in degrees there.
    pub const NAMES: [&str; 18] = [
        "x_m",
        "y_m",
        "z_m",
        "vx_mps",
        "vy_mps",
        "vz_mps",
        "heading_deg",
        "pitch_deg",
        "roll_deg",
        "sigma_x_m",
        "sigma_y_m",
        "sigma_z_m",
        "sigma_vx_mps",
        "sigma_vy_mps",
        "sigma_vz_mps",
        "sigma_heading_deg",
        "sigma_pitch_deg",
        "sigma_roll_deg",
    ];

    /// Of values as they are named, in that order; what is absent is 0, and a body none of whose angles is known is not turned.
    pub fn from_named(values: &[Option<f64>; 18]) -> Self {
        let triple = |first: usize| -> Place {
            Place::from_fn(|axis, _| values[first + axis].unwrap_or_default())
        };
        let angles = triple(6).map(f64::to_radians);
        let attitude = Attitude {
            heading_rad: angles.x,
            pitch_rad: angles.y,
            roll_rad: angles.z,
        };
        let sigmas_rad = triple(15).map(f64::to_radians);
        Pose {
            place: triple(0),
            velocity: triple(3),
            attitude: values[6..9].iter().any(Option::is_some).then_some(attitude),
            sigmas: PoseSigmas {
                place: triple(9),
                velocity: triple(12),
                heading_rad: sigmas_rad.x,
                pitch_rad: sigmas_rad.y,
                roll_rad: sigmas_rad.z,
            },
        }
    }

    /// At rest and not turned.
    pub fn at(place: Place) -> Self {
        Pose {
            place,
            ..Pose::default()
        }
    }

    pub fn is_finite(&self) -> bool {
        let attitude = self.attitude.unwrap_or_default();
        let sigmas = &self.sigmas;
        let places = [self.place, self.velocity, sigmas.place, sigmas.velocity];
        let angles = [
            attitude.heading_rad,
            attitude.pitch_rad,
            attitude.roll_rad,
            sigmas.heading_rad,
            sigmas.pitch_rad,
            sigmas.roll_rad,
        ];
        let mut values = places.iter().flat_map(|place| place.iter()).chain(&angles);
        values.all(|value| value.is_finite())
    }

    /// Whether any of its standard deviations is above 0.
    pub fn is_uncertain(&self) -> bool {
        let sigmas = &self.sigmas;
        let places = sigmas.place.iter().chain(&sigmas.velocity);
        let angles = [sigmas.heading_rad, sigmas.pitch_rad, sigmas.roll_rad];
        places.chain(&angles).any(|sigma| *sigma != 0.0)
    }

    /// Variance that the attitude adds to the bearing (from north) of a target at the sensor's height (rad²), to first order.
    pub fn bearing_variance(&self, bearing_rad: f64) -> f64 {
        let attitude = self.attitude.unwrap_or_default();
        let sigmas = &self.sigmas;
        let heading = sigmas.heading_rad.powi(2);
        if sigmas.pitch_rad == 0.0 && sigmas.roll_rad == 0.0 {
            return heading;
        }
        let [by_pitch, by_roll] = attitude.slopes(bearing_rad);
        heading + (by_pitch * sigmas.pitch_rad).powi(2) + (by_roll * sigmas.roll_rad).powi(2)
    }
}

impl Attitude {
    /// North, east, down of forward, starboard, down.
    pub fn rotation(&self) -> Matrix3<f64> {
        let (sin_h, cos_h) = self.heading_rad.sin_cos();
        let (sin_p, cos_p) = self.pitch_rad.sin_cos();
        let (sin_r, cos_r) = self.roll_rad.sin_cos();
        Matrix3::new(cos_h, -sin_h, 0.0, sin_h, cos_h, 0.0, 0.0, 0.0, 1.0)
            * Matrix3::new(cos_p, 0.0, sin_p, 0.0, 1.0, 0.0, -sin_p, 0.0, cos_p)
            * Matrix3::new(1.0, 0.0, 0.0, 0.0, cos_r, -sin_r, 0.0, sin_r, cos_r)
    }

    /// Bearing from north and elevation above the horizon of a direction that the body sees.
    pub fn direction(&self, bearing_rad: f64, elevation_rad: f64) -> (f64, f64) {
        let (sin_b, cos_b) = bearing_rad.sin_cos();
        let (sin_e, cos_e) = elevation_rad.sin_cos();
        let seen = self.rotation() * Vector3::new(cos_e * cos_b, cos_e * sin_b, -sin_e);
        (seen.y.atan2(seen.x), (-seen.z).atan2(seen.x.hypot(seen.y)))
    }

    /// Bearing from north of a target at the sensor's height, of its bearing from the bow.
    pub fn bearing_of(&self, relative_rad: f64) -> f64 {
        if self.pitch_rad == 0.0 && self.roll_rad == 0.0 {
            return wrap(self.heading_rad + relative_rad);
        }
        let (sin_b, cos_b) = relative_rad.sin_cos();
        let (sin_p, cos_p) = self.pitch_rad.sin_cos();
        let (sin_r, cos_r) = self.roll_rad.sin_cos();
        let up = sin_b * sin_r * cos_p - cos_b * sin_p;
        let elevation_rad = up.atan2(cos_r * cos_p);
        self.direction(relative_rad, elevation_rad).0
    }

    /// Slopes of that bearing with pitch and roll where the bow's bearing is kept, at a bearing from north.
    fn slopes(&self, bearing_rad: f64) -> [f64; 2] {
        let (sin_l, cos_l) = (bearing_rad - self.heading_rad).sin_cos();
        let (cos_p, tan_p) = (self.pitch_rad.cos(), self.pitch_rad.tan());
        let (cos_r, tan_r) = (self.roll_rad.cos(), self.roll_rad.tan());
        // The bearing from the bow, along whose circle λ is differentiated: forward x, starboard y.
        let forward = cos_l * cos_p;
        let starboard = cos_r * (sin_l + forward * tan_p * tan_r);
        let across = starboard / cos_r - forward * tan_p * tan_r;
        let along = forward / cos_p;
        let square = across * across + along * along;
        let across_by_pitch = -forward * tan_r / (cos_p * cos_p);
        let along_by_pitch = forward * tan_p / cos_p;
        let across_by_roll = starboard * tan_r / cos_r - forward * tan_p / (cos_r * cos_r);
        [
            (along * across_by_pitch - across * along_by_pitch) / square,
            along * across_by_roll / square,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked with numpy, axes in the order of aerospace.
    const TURNED: Attitude = Attitude {
        heading_rad: 30.0 * std::f64::consts::PI / 180.0,
        pitch_rad: 5.0 * std::f64::consts::PI / 180.0,
        roll_rad: -10.0 * std::f64::consts::PI / 180.0,
    };

    #[test]
    fn a_body_that_is_turned_sees_directions_as_worked_apart() {
        let (bearing_rad, elevation_rad) = TURNED.direction(40f64.to_radians(), 3f64.to_radians());
        assert!((bearing_rad.to_degrees() - 69.798_162_057_72).abs() < 1e-10);
        assert!((elevation_rad.to_degrees() - 13.241_746_100_6).abs() < 1e-10);
        let wanted = [
            [
                0.862_729_915_662_8,
                -0.505_510_682_468_6,
                -0.012_491_698_465_05,
            ],
            [
                0.498_097_349_045_9,
                0.845_301_314_001_8,
                0.193_299_558_769_2,
            ],
            [
                -0.087_155_742_747_66,
                -0.172_987_393_925_1,
                0.981_060_262_190_4,
            ],
        ];
        let found = TURNED.rotation();
        for row in 0..3 {
            for column in 0..3 {
                let error = found[(row, column)] - wanted[row][column];
                assert!(error.abs() < 1e-12, "{row} {column}: {error}");
            }
        }
    }

    #[test]
    fn with_a_heading_alone_bearings_are_added() {
        let attitude = Attitude {
            heading_rad: 300f64.to_radians(),
            ..Attitude::default()
        };
        let bearing_rad = attitude.bearing_of(100f64.to_radians());
        assert!((bearing_rad.to_degrees() - 40.0).abs() < 1e-12);
        // The same along the way of all attitudes.
        let (bearing_rad, _) = attitude.direction(100f64.to_radians(), 0.0);
        assert!((bearing_rad.to_degrees() - 40.0).abs() < 1e-12);
    }

    #[test]
    fn a_level_target_comes_back_from_the_body() {
        // North, east, down of a level target, seen along the body's axes.
        for step in 0..24 {
            let bearing_rad = wrap(f64::from(step).mul_add(15f64.to_radians(), 0.1));
            let (sine, cosine) = bearing_rad.sin_cos();
            let body = TURNED.rotation().transpose() * Vector3::new(cosine, sine, 0.0);
            let found = TURNED.bearing_of(body.y.atan2(body.x));
            assert!(wrap(found - bearing_rad).abs() < 1e-12, "{step}: {found}");
        }
    }

    #[test]
    fn pitch_and_roll_turn_a_bearing_as_differences_say() {
        let step = 1e-5;
        for degrees in [-170.0, -80.0, -20.0, 3.0, 70.0, 140.0] {
            let relative_rad = f64::to_radians(degrees);
            let turned = |pitch: f64, roll: f64| {
                let attitude = Attitude {
                    pitch_rad: TURNED.pitch_rad + pitch,
                    roll_rad: TURNED.roll_rad + roll,
                    ..TURNED
                };
                attitude.bearing_of(relative_rad)
            };
            let [by_pitch, by_roll] = TURNED.slopes(turned(0.0, 0.0));
            let pitch = wrap(turned(step, 0.0) - turned(-step, 0.0)) / (2.0 * step);
            let roll = wrap(turned(0.0, step) - turned(0.0, -step)) / (2.0 * step);
            assert!(
                (by_pitch - pitch).abs() < 1e-8,
                "{degrees}: {by_pitch} {pitch}"
            );
            assert!((by_roll - roll).abs() < 1e-8, "{degrees}: {by_roll} {roll}");
        }
    }

    #[test]
    fn the_attitude_adds_to_a_bearing_by_its_slopes() {
        let mut pose = Pose {
            attitude: Some(TURNED),
            ..Pose::default()
        };
        pose.sigmas.heading_rad = 0.01;
        assert_eq!(pose.bearing_variance(1.0), 1e-4);
        (pose.sigmas.pitch_rad, pose.sigmas.roll_rad) = (0.02, 0.03);
        let [by_pitch, by_roll] = TURNED.slopes(1.0);
        let wanted = 1e-4 + (0.02 * by_pitch).powi(2) + (0.03 * by_roll).powi(2);
        assert!((pose.bearing_variance(1.0) - wanted).abs() < 1e-18);
    }
}
