//! Where a filter expects the next report of a track: the centre and spread of its gate, for those who draw it. Of space that is
//! the shadow on the plane.

use crate::filtering::{Corrector, Filter, WithCorrector};
use crate::model::sensing::MeasurementModel;
use crate::model::state::{GaussianState, Position, PositionCovariance};
use nalgebra::Vector2;

/// The first two values of an expected report.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedRegion {
    /// Where the target itself is expected.
    pub place_m: Position,
    /// ẑ.
    pub measurement: Vector2<f64>,
    /// S.
    pub covariance: PositionCovariance,
    /// The value that is an angle, if there is one.
    pub angle: Option<usize>,
}

/// After `dt_s`, of a target with these kinematics. `None` for reports of one value, and where nothing can be expected.
pub fn expect<F: Filter<K>, const K: usize>(
    filter: &F,
    model: &MeasurementModel,
    kinematics: &GaussianState<K>,
    dt_s: f64,
) -> Option<ExpectedRegion> {
    let mut belief = filter.begin(kinematics);
    F::predict(&filter.step(dt_s), &mut belief);
    filter
        .correct(model, Expecting { belief: &belief })
        .flatten()
}

struct Expecting<'a, B> {
    belief: &'a B,
}

impl<F: Filter<K>, const K: usize> WithCorrector<F, K> for Expecting<'_, F::Belief> {
    type Output = Option<ExpectedRegion>;

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) -> Self::Output {
        if D < 2 {
            return None;
        }
        let (expected, _) = corrector.expect(self.belief)?;
        let mean = F::kinematics(self.belief).mean;
        Some(ExpectedRegion {
            place_m: Position::new(mean[0], mean[1]),
            measurement: Vector2::new(expected.measurement[0], expected.measurement[1]),
            covariance: expected.covariance.fixed_view::<2, 2>(0, 0).into_owned(),
            angle: C::ANGLE,
        })
    }
}
