//! How far the tracks of a tuple are apart, in squared distances that follow chi-square when they are of one target and their
//! errors are white in time.
//!
//! # Reference
//! Huo Liang et al., A sort of model of multi-sensor multi-object flight path connection based on GA, Journal of Air Force
//! Engineering University 9(3), 2008, sections 1.2 and 1.3; Y. Bar-Shalom, On the track-to-track correlation problem, IEEE
//! Transactions on Automatic Control 26, 1981.
//!
//! # Symbols
//! x̂_s, P_s estimate and covariance of track s; P_ij cross-covariance of the errors of two; C_ij = P_i + P_j − P_ij − P_ijᵀ;
//! n_x numbers of a state; k times at which both of a pair, or some of a tuple, say something; m members of a tuple.
//!
//! # Method
//! - λ_ij(k) = Σ (x̂_i − x̂_j)ᵀ C_ij⁻¹ (x̂_i − x̂_j) over the k times (eq. 6): k n_x degrees of freedom.
//! - Q(k) = Σ Σ_s (x̂_s − x̄)ᵀ P_s⁻¹ (x̂_s − x̄) with x̄ the information-weighted mean of the tuple at each time: (m − 1) n_x
//!   degrees of freedom a time, m the members there. It is λ for two. With cross-covariances it is dᵀ D⁻¹ d of the differences d to
//!   the first member, D their covariance: the same number where the cross-covariances are 0.
//! - ln ∫ Π N(x̂_s; x, P_s) dx = ln N(d; 0, D): how probable the differences are.

use super::cross_covariance::CrossTable;
use super::estimates::{AlignedEstimate, Estimates};
use crate::math::gaussian::Gaussian;
use crate::model::state::{Covariance, State};
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Which of the common times count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Times {
    All,
    /// The latest at which both of a pair, or most of a tuple, say something.
    Latest,
}

/// The estimates as far as they are looked at.
#[derive(Debug, Clone)]
pub struct Evidence {
    pub estimates: Arc<Estimates>,
    pub cross: Option<Arc<CrossTable>>,
    pub times: Times,
    /// Only the times before this index.
    pub until: usize,
}

/// Of two tracks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// λ.
    pub lambda: f64,
    /// k.
    pub times: usize,
}

/// Of a tuple.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spread {
    /// Q.
    pub q: f64,
    pub degrees_of_freedom: usize,
    /// ln ∫ Π N(x̂_s; x, P_s) dx, summed over the times.
    pub log_density: f64,
    pub times: usize,
}

impl Evidence {
    /// `None` for tracks without a common time.
    pub fn pair(&self, a: u32, b: u32) -> Option<Pair> {
        let (left, right) = (self.estimates.of_track(a), self.estimates.of_track(b));
        let cross = self.cross.as_ref().and_then(|table| table.of_pair(a, b));
        let mut pair = Pair {
            lambda: 0.0,
            times: 0,
        };
        for time in (0..self.until).rev() {
            let (Some(x), Some(y)) = (&left[time], &right[time]) else {
                continue;
            };
            let mut covariance = x.covariance + y.covariance;
            if let Some(cross) = cross {
                covariance -= cross[time] + cross[time].transpose();
            }
            let Some(gaussian) = Gaussian::new(&covariance) else {
                continue;
            };
            pair.lambda += gaussian.squared_distance(&(x.mean - y.mean));
            pair.times += 1;
            if self.times == Times::Latest {
                break;
            }
        }
        (pair.times > 0).then_some(pair)
    }

    /// Of two members or more.
    pub fn spread(&self, tuple: &[u32]) -> Spread {
        let mut total = Spread::default();
        match self.times {
            Times::All => (0..self.until).for_each(|time| self.add(tuple, time, &mut total)),
            Times::Latest => self
                .fullest_time(tuple)
                .into_iter()
                .for_each(|time| self.add(tuple, time, &mut total)),
        }
        total
    }

    /// The latest of the times at which most of the tuple say something.
    pub(super) fn fullest_time(&self, tuple: &[u32]) -> Option<usize> {
        let members = |time: usize| {
            tuple
                .iter()
                .filter(|&&track| self.estimates.at(track, time).is_some())
                .count()
        };
        let mut best = None;
        for time in (0..self.until).rev() {
            let count = members(time);
            if best.is_none_or(|(most, _)| count > most) {
                best = Some((count, time));
            }
            if count == tuple.len() {
                break;
            }
        }
        best.map(|(_, time)| time)
    }

    /// Adds what the members say at one time, if there are two.
    fn add(&self, tuple: &[u32], time: usize, total: &mut Spread) {
        let found = match &self.cross {
            None => self.independent(tuple, time),
            Some(cross) => self.correlated(tuple, time, cross),
        };
        let Some((members, q, log_density)) = found else {
            return;
        };
        total.q += q;
        total.degrees_of_freedom += (members - 1) * self.estimates.dimensions();
        total.log_density += log_density + self.velocity_constant(members);
        total.times += 1;
    }

    /// Where velocities are not compared the densities hold those of [`Estimates::has_velocity`], ∫ Π N(0; v, 1) dv on each of two
    /// axes, which are taken out again.
    fn velocity_constant(&self, members: usize) -> f64 {
        let count = members as f64;
        if self.estimates.has_velocity {
            0.0
        } else {
            (count - 1.0) * TAU.ln() + count.ln()
        }
    }

    /// Members there, Q and the log-density, by sums of information, relative to the first member.
    fn independent(&self, tuple: &[u32], time: usize) -> Option<(usize, f64, f64)> {
        let mut origin: Option<State> = None;
        let (mut information, mut vector) = (Covariance::zeros(), State::zeros());
        let (mut members, mut squares, mut peaks) = (0, 0.0, 0.0);
        for estimate in tuple
            .iter()
            .filter_map(|&track| self.estimates.at(track, time))
        {
            let difference = estimate.mean - *origin.get_or_insert(estimate.mean);
            let weighted = estimate.gaussian.inverse() * difference;
            information += estimate.gaussian.inverse();
            vector += weighted;
            squares += difference.dot(&weighted);
            peaks += estimate.gaussian.log_density(0.0);
            members += 1;
        }
        if members < 2 {
            return None;
        }
        let mean = Gaussian::new(&information)?;
        let q = (squares - vector.dot(&(mean.inverse() * vector))).max(0.0);
        // ∫ exp(−½ (x − x̄)ᵀ A (x − x̄)) dx = (2π)² / √det A.
        Some((
            members,
            q,
            peaks - 0.5 * q + 4.0 * TAU.ln() + mean.log_density(0.0),
        ))
    }

    /// The same by the covariance of the differences.
    fn correlated(
        &self,
        tuple: &[u32],
        time: usize,
        cross: &CrossTable,
    ) -> Option<(usize, f64, f64)> {
        let present: Vec<(u32, &AlignedEstimate)> = tuple
            .iter()
            .filter_map(|&track| Some((track, self.estimates.at(track, time)?)))
            .collect();
        let (&(first, reference), rest) = present.split_first()?;
        if rest.is_empty() {
            return None;
        }
        let size = 4 * rest.len();
        let (mut differences, mut covariance) = (DVector::zeros(size), DMatrix::zeros(size, size));
        let of = |a: u32, b: u32| cross.at(a, b, time);
        for (row, &(left, estimate)) in rest.iter().enumerate() {
            differences
                .rows_mut(4 * row, 4)
                .copy_from(&(estimate.mean - reference.mean));
            for (column, &(right, _)) in rest.iter().enumerate() {
                let own = if row == column {
                    estimate.covariance
                } else {
                    of(left, right)
                };
                let block = own + reference.covariance - of(left, first) - of(first, right);
                covariance
                    .view_mut((4 * row, 4 * column), (4, 4))
                    .copy_from(&block);
            }
        }
        let decomposed = covariance.cholesky()?;
        let q = differences.dot(&decomposed.solve(&differences));
        let log_determinant = 2.0
            * decomposed
                .l_dirty()
                .diagonal()
                .iter()
                .map(|value| value.ln())
                .sum::<f64>();
        Some((
            present.len(),
            q,
            -0.5 * (q + size as f64 * TAU.ln() + log_determinant),
        ))
    }
}
