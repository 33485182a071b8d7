//! Tracks that are fed by groups of reports: predicted from instant to instant with nearly constant velocity, and updated with
//! every report of their group, one after another at one time.
//!
//! They are what groupers use as predictions: given when they begin, never confirmed, never ended.

use crate::filtering::Filter;
use crate::filtering::kalman::Kalman;
use crate::filtering::mixture::{WeightedInnovation, update};
use crate::filtering::prediction::Transition;
use crate::model::sensor::Sensor;
use crate::model::state::{GaussianState, Position};

#[derive(Debug, Clone)]
pub struct GroupTracks {
    filter: Kalman,
    time_s: f64,
    states: Vec<GaussianState>,
}

impl GroupTracks {
    /// No tracks yet.
    pub fn new(filter: Kalman, time_s: f64) -> Self {
        GroupTracks {
            filter,
            time_s,
            states: Vec::new(),
        }
    }

    /// A track at a report. Its velocity is known, or 0 ± `speed_sigma_mps` on each axis.
    pub fn begin(
        &mut self,
        sensor: &Sensor,
        position_m: &Position,
        velocity_mps: Option<Position>,
        speed_sigma_mps: f64,
    ) {
        let sigma_mps = if velocity_mps.is_some() {
            0.0
        } else {
            speed_sigma_mps
        };
        let Some(mut state) = self.filter.initiate(position_m, sensor, sigma_mps) else {
            return;
        };
        let velocity_mps = velocity_mps.unwrap_or_else(Position::zeros);
        (state.mean[2], state.mean[3]) = (velocity_mps[0], velocity_mps[1]);
        self.states.push(state);
    }

    pub fn predict(&mut self, time_s: f64) {
        let transition = Transition::new(self.filter.motion(), time_s - self.time_s);
        self.states
            .iter_mut()
            .for_each(|state| transition.predict(state));
        self.time_s = time_s;
    }

    /// A track with one more report at its time.
    pub fn update(&mut self, track: usize, sensor: &Sensor, position_m: &Position) {
        let state = &mut self.states[track];
        if let Some(expected) = self.filter.expect(state, sensor) {
            let innovation = position_m - expected.measurement;
            update(
                state,
                &expected.correction(),
                &[WeightedInnovation {
                    innovation,
                    weight: 1.0,
                }],
            );
        }
    }

    pub fn states(&self) -> &[GaussianState] {
        &self.states
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::sensor::MeasurementModel;

    fn sensor() -> Sensor {
        let report = MeasurementModel::Position {
            sigma_x_m: 3.0,
            sigma_y_m: 3.0,
        };
        Sensor {
            sensor_id: "S".into(),
            p_d: 1.0,
            clutter_density: 0.0,
            report,
        }
    }

    #[test]
    fn reports_of_one_time_are_averaged_and_the_velocity_carries_on() {
        let mut tracks = GroupTracks::new(
            Kalman {
                process_noise_m2ps3: 0.0,
            },
            10.0,
        );
        tracks.begin(
            &sensor(),
            &Position::new(1.0, 0.0),
            Some(Position::new(4.0, -2.0)),
            100.0,
        );
        tracks.update(0, &sensor(), &Position::new(4.0, 6.0));
        tracks.update(0, &sensor(), &Position::new(7.0, 0.0));
        // The mean of three; a third of the variance; the velocity is known for certain and stays.
        let state = &tracks.states()[0];
        assert!((state.mean - nalgebra::Vector4::new(4.0, 2.0, 4.0, -2.0)).norm() < 1e-12);
        assert!((state.covariance[(0, 0)] - 3.0).abs() < 1e-12 && state.covariance[(2, 2)] == 0.0);
        tracks.predict(12.0);
        assert!(
            (tracks.states()[0].mean - nalgebra::Vector4::new(12.0, -2.0, 4.0, -2.0)).norm()
                < 1e-12
        );
    }

    #[test]
    fn an_unknown_velocity_is_learnt_from_the_second_report() {
        // P = diag(9, 100²) → after 1 s S = 9 + 10⁴ + 9, K_v = 10⁴ / S: v = 10⁴/10018 · 50.
        let mut tracks = GroupTracks::new(
            Kalman {
                process_noise_m2ps3: 0.0,
            },
            0.0,
        );
        tracks.begin(&sensor(), &Position::zeros(), None, 100.0);
        tracks.predict(1.0);
        tracks.update(0, &sensor(), &Position::new(50.0, 0.0));
        assert!((tracks.states()[0].mean[2] - 50.0 * 10_000.0 / 10_018.0).abs() < 1e-9);
    }
}
