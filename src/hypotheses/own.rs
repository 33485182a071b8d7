//! Rows of scans whose detections have noises and times of their own: each detection is compared with what it should be itself.
//!
//! # Method
//! 1. The earliest and the latest time of the scan, with the largest noises and with the sensor's, bound where any of its detections
//!    may be expected; the grid finds those that lie there.
//! 2. Each of them is expected by itself, with its R and its H F(t), and is a candidate inside its own gate. The track's loss is the mean
//!    of those of its candidates.

use super::Hypotheses;
use super::detections::Detections;
use super::likelihood_constants::LikelihoodConstants;
use crate::association::Needs;
use crate::association::problem::Edge;
use crate::filtering::{Corrector, Expected, Filter};
use crate::gating::ellipsoidal::{EllipsoidalGate, Hull};
use crate::model::angle;
use crate::model::own::{Own, OwnNoise};
use crate::model::scan::Scan;
use nalgebra::SVector;

/// What bounds all that the detections of a scan have of their own: between these lies where any of them may be expected.
#[derive(Debug)]
pub(super) struct Bounds(Vec<Own>);

impl Bounds {
    /// The earliest and the latest time, each with the sensor's noise and with the largest; none twice.
    pub fn of(scan: &Scan) -> Self {
        let (mut times_s, mut widest) = ([0.0f64; 2], OwnNoise::default());
        // Where a velocity is expected does not depend on it, but whether one is told does.
        let mut velocity_mps = None;
        for own in &scan.own {
            times_s = [times_s[0].min(own.after_s), times_s[1].max(own.after_s)];
            widest = widest.widest(&own.noise);
            velocity_mps = velocity_mps.or(own.velocity_mps);
        }
        let mut corners = Vec::with_capacity(4);
        for noise in [OwnNoise::default(), widest] {
            for after_s in times_s {
                let corner = Own {
                    after_s,
                    noise,
                    velocity_mps,
                };
                if !corners.contains(&corner) {
                    corners.push(corner);
                }
            }
        }
        Bounds(corners)
    }
}

/// A track that detections are compared with, one by one.
pub(super) struct Track<'a, C, B, const D: usize> {
    pub corrector: &'a C,
    pub belief: &'a B,
    /// ẑ at the time of the scan.
    pub expected: &'a SVector<f64, D>,
    pub scan: &'a Scan,
    pub bounds: &'a Bounds,
    pub constants: &'a LikelihoodConstants,
    pub origin: Option<u32>,
    /// What alone it may have caused, where that is known.
    pub only: Option<&'a [u32]>,
}

impl<F: Filter<K>, const K: usize> Hypotheses<F, K> {
    /// Steps 1 and 2: adds the candidates of a track to the open row, with their changes and losses.
    #[inline(never)]
    pub(super) fn push_own_edges<C: Corrector<F, K, D>, const D: usize>(
        &mut self,
        track: &Track<C, F::Belief, D>,
    ) {
        let is_seen = track.constants.p_d > 0.0;
        let own = self
            .detections
            .own(track.origin)
            .filter(|_| is_seen && self.needs.is_by_origin());
        if self.needs == Needs::OriginsInGates {
            self.problem.push_own(own);
        }
        if !is_seen {
            return;
        }
        if let Some(own) = own {
            let point = SVector::from(self.detections.points::<D>()[own as usize]);
            self.push_own_edge(track, None, (own, point));
        }
        if self.needs == Needs::Origins {
            return;
        }
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        match track.only {
            None => find_near(&self.detections, &self.gate, track, &mut near),
            Some(only) => near.extend(only.iter().filter(|&&at| !self.is_used(at as usize))),
        }
        let gate = self.gate;
        for &detection in near.iter().filter(|&&detection| Some(detection) != own) {
            let point = SVector::from(self.detections.points::<D>()[detection as usize]);
            self.push_own_edge(track, Some(&gate), (detection, point));
        }
        self.near = near;
    }

    /// Step 2 for one detection, where it is inside the gate if there is one.
    fn push_own_edge<C: Corrector<F, K, D>, const D: usize>(
        &mut self,
        track: &Track<C, F::Belief, D>,
        gate: Option<&EllipsoidalGate>,
        (detection, point): (u32, SVector<f64, D>),
    ) {
        let own = track.scan.own_of(detection as usize);
        let Some((expected, gain)) = track.corrector.expect_own(track.belief, &own) else {
            return;
        };
        let is_inside = |gate: &EllipsoidalGate| {
            if C::HAS_REGIONS {
                let regions = C::regions(&gain).iter().map(Expected::as_region);
                gate.is_inside(&point, C::ANGLE, regions)
            } else {
                gate.is_inside(&point, C::ANGLE, std::iter::once(expected.as_region()))
            }
        };
        if !gate.is_none_or(is_inside) {
            return;
        }
        let innovation = angle::difference(&point, &expected.measurement, C::ANGLE);
        if self.needs == Needs::Places {
            let (expected, innovation) = (track.expected.as_slice(), innovation.as_slice());
            self.problem.push_moved(expected, innovation);
        }
        let squared_distance = expected.gaussian.squared_distance(&innovation);
        let (change, log_there) = C::assess(&gain, &expected, &innovation, squared_distance);
        let log_scale = track
            .corrector
            .log_clutter_scale_own(&expected.measurement, &own);
        let more_clutter = self.log_clutter_ratio(detection as usize);
        self.changes.push(change);
        self.losses.push(C::loss(&gain));
        self.problem.push_edge(Edge {
            detection,
            squared_distance,
            log_likelihood: track.constants.log_density - log_scale + log_there - more_clutter,
        });
    }
}

/// Step 1.
fn find_near<F: Filter<K>, C: Corrector<F, K, D>, const K: usize, const D: usize>(
    detections: &Detections,
    gate: &EllipsoidalGate,
    track: &Track<C, F::Belief, D>,
    near: &mut Vec<u32>,
) {
    let mut hull = Hull::default();
    for own in &track.bounds.0 {
        let Some((expected, gain)) = track.corrector.expect_own(track.belief, own) else {
            continue;
        };
        if !C::HAS_REGIONS {
            hull.add(gate, expected.as_region(), C::ANGLE);
        }
        for region in C::regions(&gain) {
            hull.add(gate, region.as_region(), C::ANGLE);
        }
    }
    detections.near(&hull, C::ANGLE, near);
}
