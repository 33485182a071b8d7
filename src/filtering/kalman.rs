//! The Kalman filter for position reports of a target with nearly constant velocity.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.2.
//!
//! # Symbols
//! x̂, P state and covariance; H = \[I 0\]; R, S noise and innovation covariance; C = cov(x, z).
//!
//! # Method
//! ẑ = H x̂, S = H P Hᵀ + R, C = P Hᵀ; prediction and update are those of all filters.

use super::mixture::Expected;
use super::{AnyFilter, Filter, FilterMethod, PROCESS_NOISE};
use crate::model::motion::ConstantVelocity;
use crate::model::scan::Measurement;
use crate::model::sensor::{MeasurementModel, Sensor};
use crate::model::state::{Covariance, GaussianState, Position, PositionCovariance, State};
use crate::registry::Object;
use serde::Deserialize;

pub const METHOD: FilterMethod = FilterMethod {
    name: "kalman",
    parameters: &PARAMETERS,
    build: |spec| Kalman::deserialize(spec).map(AnyFilter::Kalman),
};

static PARAMETERS: Object = Object {
    name: "KalmanFilter",
    summary: "Kalman filter for position reports, nearly constant velocity.",
    fields: &[PROCESS_NOISE],
};

/// The filter of one tracker.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Kalman {
    pub process_noise_m2ps3: f64,
}

impl Filter<4, 2> for Kalman {
    fn motion(&self) -> ConstantVelocity {
        ConstantVelocity {
            spectral_density: self.process_noise_m2ps3,
        }
    }

    fn to_measurement_space(
        &self,
        _sensor: &Sensor,
        measurement: &Measurement,
    ) -> Option<Position> {
        measurement.position()
    }

    #[inline(always)]
    fn expect(&self, state: &GaussianState, sensor: &Sensor) -> Option<Expected<4, 2>> {
        expect_position(state, &noise_of(&sensor.report)?)
    }

    fn initiate(
        &self,
        measurement: &Position,
        sensor: &Sensor,
        speed_sigma_mps: f64,
    ) -> Option<GaussianState> {
        Some(at_rest(
            measurement,
            &noise_of(&sensor.report)?,
            speed_sigma_mps,
        ))
    }
}

/// R of a position report.
#[inline]
pub(super) fn noise_of(report: &MeasurementModel) -> Option<PositionCovariance> {
    let MeasurementModel::Position {
        sigma_x_m,
        sigma_y_m,
    } = *report
    else {
        return None;
    };
    Some(PositionCovariance::new(
        sigma_x_m * sigma_x_m,
        0.0,
        0.0,
        sigma_y_m * sigma_y_m,
    ))
}

/// ẑ, S and C of a position with noise R.
#[inline(always)]
pub(super) fn expect_position(
    state: &GaussianState,
    noise: &PositionCovariance,
) -> Option<Expected<4, 2>> {
    let covariance = state.covariance.fixed_view::<2, 2>(0, 0) + noise;
    let cross = state.covariance.fixed_columns::<2>(0).into_owned();
    Expected::new(
        Position::new(state.mean[0], state.mean[1]),
        covariance,
        cross,
    )
}

/// One-point initiation: at a position, with velocity 0 ± `speed_sigma_mps` on each axis.
pub(super) fn at_rest(
    position_m: &Position,
    noise: &PositionCovariance,
    speed_sigma_mps: f64,
) -> GaussianState {
    let mut covariance = Covariance::zeros();
    covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(noise);
    covariance[(2, 2)] = speed_sigma_mps * speed_sigma_mps;
    covariance[(3, 3)] = speed_sigma_mps * speed_sigma_mps;
    GaussianState {
        mean: State::new(position_m[0], position_m[1], 0.0, 0.0),
        covariance,
    }
}

#[cfg(test)]
mod tests {
    use super::super::mixture::{WeightedInnovation, update};
    use super::*;

    fn sensor(xx: f64, yy: f64) -> Sensor {
        let report = MeasurementModel::Position {
            sigma_x_m: f64::sqrt(xx),
            sigma_y_m: f64::sqrt(yy),
        };
        Sensor {
            sensor_id: "radar".into(),
            p_d: 0.9,
            clutter_density: 1e-8,
            report,
        }
    }

    fn filter() -> Kalman {
        Kalman {
            process_noise_m2ps3: 0.5,
        }
    }

    fn started() -> GaussianState {
        let state = filter()
            .initiate(&Position::new(1.0, 2.0), &sensor(4.0, 9.0), 10.0)
            .unwrap();
        GaussianState {
            mean: State::new(1.0, 2.0, 3.0, -1.0),
            ..state
        }
    }

    #[test]
    fn one_certain_detection_gives_the_textbook_update() {
        // One axis by hand: P = 4, R = 12 → S = 16, K = 1/4; ν = 8 → x = 1 + 2 = 3, P = 4 − 4·4/16 = 3.
        let mut state = started();
        let expected = filter().expect(&state, &sensor(12.0, 9.0)).unwrap();
        let detection = WeightedInnovation {
            innovation: Position::new(8.0, 0.0),
            weight: 1.0,
        };
        update(&mut state, &expected.correction(), &[detection]);
        assert!(
            (state.mean[0] - 3.0).abs() < 1e-12 && (state.covariance[(0, 0)] - 3.0).abs() < 1e-12
        );
        assert!((state.covariance[(1, 1)] - 4.5).abs() < 1e-12);
    }

    #[test]
    fn two_weighted_detections_spread_the_covariance() {
        // The axis above with ν = ±8, β = 0.4 each, β₀ = 0.2: ν̄ = 0, P = 4 − 0.8·1 + (1/4)²·(0.8·64) = 6.4.
        let mut state = started();
        let expected = filter().expect(&state, &sensor(12.0, 9.0)).unwrap();
        let detection = |x_m| WeightedInnovation {
            innovation: Position::new(x_m, 0.0),
            weight: 0.4,
        };
        update(
            &mut state,
            &expected.correction(),
            &[detection(8.0), detection(-8.0)],
        );
        assert!((state.mean[0] - 1.0).abs() < 1e-12);
        assert!((state.covariance[(0, 0)] - 6.4).abs() < 1e-12);
    }

    #[test]
    fn no_detection_changes_nothing() {
        let mut state = started();
        let expected = filter().expect(&state, &sensor(1.0, 1.0)).unwrap();
        update(&mut state, &expected.correction(), &[]);
        assert_eq!(state, started());
    }
}
