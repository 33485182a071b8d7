//! What the tracks of several sensors say at common times: the material of every statistic and of every fusion.

use crate::math::gaussian::Gaussian;
use crate::model::state::{Covariance, GaussianState, State};

/// What one track says at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlignedEstimate {
    pub mean: State,
    pub covariance: Covariance,
    /// P⁻¹ and the constant of the density.
    pub gaussian: Gaussian<4>,
}

impl AlignedEstimate {
    /// `None` when the covariance is not positive definite.
    pub fn new(state: &GaussianState) -> Option<Self> {
        Some(AlignedEstimate {
            mean: state.mean,
            covariance: state.covariance,
            gaussian: Gaussian::new(&state.covariance)?,
        })
    }
}

/// The tracks of all sensors, numbered through, at common times.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimates {
    pub sensor_ids: Vec<String>,
    /// Tracks of each sensor.
    pub tracks_of: Vec<usize>,
    pub track_ids: Vec<String>,
    pub times_s: Vec<f64>,
    /// Time by time of track by track; `None` where a track says nothing at a time.
    table: Vec<Option<AlignedEstimate>>,
    /// Whether velocities are compared. Where they are not, every velocity is 0 ± 1 m/s in all tracks, without covariance with
    /// the position: then it adds nothing to a distance, and the same algebra serves both.
    pub has_velocity: bool,
}

impl Estimates {
    /// With an empty table.
    pub fn new(sensors: Vec<(String, Vec<String>)>, times_s: Vec<f64>, has_velocity: bool) -> Self {
        let tracks_of: Vec<usize> = sensors.iter().map(|(_, tracks)| tracks.len()).collect();
        let table = vec![None; tracks_of.iter().sum::<usize>() * times_s.len()];
        let (sensor_ids, tracks): (Vec<String>, Vec<Vec<String>>) = sensors.into_iter().unzip();
        Estimates {
            sensor_ids,
            tracks_of,
            track_ids: tracks.concat(),
            times_s,
            table,
            has_velocity,
        }
    }

    /// Takes what a track says at a time; `false` when its covariance is not positive definite and it is left out.
    pub fn set(&mut self, track: usize, time: usize, state: &GaussianState) -> bool {
        let mut state = *state;
        if !self.has_velocity {
            without_velocity(&mut state);
        }
        let estimate = AlignedEstimate::new(&state);
        self.table[track * self.times_s.len() + time] = estimate;
        estimate.is_some()
    }

    pub fn at(&self, track: u32, time: usize) -> Option<&AlignedEstimate> {
        self.table[track as usize * self.times_s.len() + time].as_ref()
    }

    /// Everything that a track says, by time.
    pub fn of_track(&self, track: u32) -> &[Option<AlignedEstimate>] {
        let times = self.times_s.len();
        &self.table[track as usize * times..(track as usize + 1) * times]
    }

    pub fn tracks(&self) -> usize {
        self.track_ids.len()
    }

    pub fn times(&self) -> usize {
        self.times_s.len()
    }

    /// n_x: the numbers of a state that are compared.
    pub fn dimensions(&self) -> usize {
        if self.has_velocity { 4 } else { 2 }
    }

    /// The sensor of each track.
    pub fn sensors_of_tracks(&self) -> Vec<usize> {
        self.tracks_of
            .iter()
            .enumerate()
            .flat_map(|(sensor, &count)| std::iter::repeat_n(sensor, count))
            .collect()
    }
}

fn without_velocity(state: &mut GaussianState) {
    for rate in 2..4 {
        state.mean[rate] = 0.0;
        state.covariance.row_mut(rate).fill(0.0);
        state.covariance.column_mut(rate).fill(0.0);
        state.covariance[(rate, rate)] = 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_velocities_the_position_alone_counts() {
        let mut estimates = Estimates::new(
            vec![
                ("a".into(), vec!["1".into()]),
                ("b".into(), vec!["2".into()]),
            ],
            vec![0.0],
            false,
        );
        let mut state = GaussianState {
            mean: State::new(1.0, 2.0, 30.0, 40.0),
            covariance: Covariance::identity() * 4.0,
        };
        state.covariance[(0, 2)] = 1.0;
        state.covariance[(2, 0)] = 1.0;
        assert!(estimates.set(1, 0, &state));
        let estimate = estimates.at(1, 0).unwrap();
        assert_eq!(
            (
                estimate.mean,
                estimate.covariance[(0, 2)],
                estimates.dimensions()
            ),
            (State::new(1.0, 2.0, 0.0, 0.0), 0.0, 2)
        );
        assert_eq!(
            (estimates.at(0, 0), estimates.sensors_of_tracks()),
            (None, vec![0, 1])
        );
        state.covariance[(0, 0)] = -1.0;
        assert!(!estimates.set(1, 0, &state));
    }
}
