//! Tracks that are fed by groups of reports: predicted from instant to instant with nearly constant velocity, and updated with
//! every report of their group, one after another at one time.
//!
//! They are what groupers use as predictions: given when they begin, never confirmed, never ended.

use crate::filtering::gaussian::GaussianFilter;
use crate::filtering::{Filter, Reports, Way};
use crate::hypotheses::certain;
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::model::scan::Measurement;
use crate::model::sensor::Sensor;
use crate::model::state::{GaussianState, Position};

type PlaneFilter = GaussianFilter<ConstantVelocity, 4, 4>;

#[derive(Debug, Clone)]
pub struct GroupTracks {
    filter: PlaneFilter,
    time_s: f64,
    states: Vec<GaussianState>,
}

impl GroupTracks {
    /// No tracks yet.
    pub fn new(motion: ConstantVelocity, time_s: f64) -> Self {
        GroupTracks {
            filter: GaussianFilter::new(motion, Way::Line, Reports::Positions),
            time_s,
            states: Vec::new(),
        }
    }

    /// A track at a report. Its velocity is known, or 0 ± `speed_sigma_mps` on each axis.
    pub fn begin(
        &mut self,
        sensor: &Sensor,
        report: &Measurement,
        velocity_mps: Option<Position>,
        speed_sigma_mps: f64,
    ) {
        let rate_sigma = if velocity_mps.is_some() {
            0.0
        } else {
            speed_sigma_mps
        };
        let Some(mut state) = certain::locate(&self.filter, &sensor.report, report, rate_sigma)
        else {
            return;
        };
        let velocity_mps = velocity_mps.unwrap_or_else(Position::zeros);
        (state.mean[2], state.mean[3]) = (velocity_mps[0], velocity_mps[1]);
        self.states.push(state);
    }

    pub fn predict(&mut self, time_s: f64) {
        let step = self.filter.step(time_s - self.time_s);
        self.states
            .iter_mut()
            .for_each(|state| PlaneFilter::predict(&step, state));
        self.time_s = time_s;
    }

    /// A track with one more report at its time.
    pub fn update(&mut self, track: usize, sensor: &Sensor, report: &Measurement) {
        certain::update(
            &self.filter,
            &sensor.report,
            report,
            &mut self.states[track],
        );
    }

    pub fn states(&self) -> &[GaussianState] {
        &self.states
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::sensing::MeasurementModel;

    fn sensor() -> Sensor {
        let report = MeasurementModel::Position {
            sigma_x_m: 3.0,
            sigma_y_m: 3.0,
        };
        Sensor {
            sensor_id: "S".into(),
            p_d: 1.0,
            clutter_density: 0.0,
            may_start: true,
            report,
            sight: None,
        }
    }

    fn at(x_m: f64, y_m: f64) -> Measurement {
        Measurement::Position { x_m, y_m }
    }

    #[test]
    fn reports_of_one_time_are_averaged_and_the_velocity_carries_on() {
        let mut tracks = GroupTracks::new(
            ConstantVelocity {
                spectral_density: 0.0,
            },
            10.0,
        );
        tracks.begin(
            &sensor(),
            &at(1.0, 0.0),
            Some(Position::new(4.0, -2.0)),
            100.0,
        );
        tracks.update(0, &sensor(), &at(4.0, 6.0));
        tracks.update(0, &sensor(), &at(7.0, 0.0));
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
            ConstantVelocity {
                spectral_density: 0.0,
            },
            0.0,
        );
        tracks.begin(&sensor(), &at(0.0, 0.0), None, 100.0);
        tracks.predict(1.0);
        tracks.update(0, &sensor(), &at(50.0, 0.0));
        assert!((tracks.states()[0].mean[2] - 50.0 * 10_000.0 / 10_018.0).abs() < 1e-9);
    }
}
