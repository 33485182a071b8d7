//! Reports whose target is known: no gate, no other hypothesis.

use crate::filtering::{Corrector, Filter, Weighted, WithCorrector};
use crate::model::angle::difference;
use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::sensing::MeasurementModel;
use crate::model::state::GaussianState;

/// The kinematics that a report alone tells; each rate that it does not tell is 0 ± `rate_sigma`. `None` where the filter cannot
/// use the report, or it does not say where its target is.
pub fn locate<F: Filter<K>, const K: usize>(
    filter: &F,
    model: &MeasurementModel,
    report: &Measurement,
    rate_sigma: f64,
) -> Option<GaussianState<K>> {
    filter
        .correct(model, Locate { report, rate_sigma })
        .flatten()
}

/// Updates a belief with a report of its target. `None`, and nothing changes, where the filter cannot use the report.
pub fn update<F: Filter<K>, const K: usize>(
    filter: &F,
    model: &MeasurementModel,
    report: &Measurement,
    belief: &mut F::Belief,
) -> Option<()> {
    update_own(filter, model, (report, &Own::default()), belief)
}

/// The same with a report that has something of its own.
pub fn update_own<F: Filter<K>, const K: usize>(
    filter: &F,
    model: &MeasurementModel,
    (report, own): (&Measurement, &Own),
    belief: &mut F::Belief,
) -> Option<()> {
    filter
        .correct(
            model,
            Update {
                report,
                own,
                belief,
            },
        )
        .flatten()
}

struct Locate<'a> {
    report: &'a Measurement,
    rate_sigma: f64,
}

impl<F: Filter<K>, const K: usize> WithCorrector<F, K> for Locate<'_> {
    type Output = Option<GaussianState<K>>;

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) -> Self::Output {
        corrector.locate(
            &corrector.read(self.report, &Own::default())?,
            self.rate_sigma,
            &Own::default(),
        )
    }
}

struct Update<'a, B> {
    report: &'a Measurement,
    own: &'a Own,
    belief: &'a mut B,
}

impl<F: Filter<K>, const K: usize> WithCorrector<F, K> for Update<'_, F::Belief> {
    type Output = Option<()>;

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) -> Option<()> {
        let report = corrector.read(self.report, self.own)?;
        let (expected, gain) = if *self.own == Own::default() {
            corrector.expect(self.belief)?
        } else {
            corrector.expect_own(self.belief, self.own)?
        };
        let innovation = difference(&report, &expected.measurement, C::ANGLE);
        let certain = Weighted {
            change: C::change(&gain, &innovation),
            weight: 1.0,
        };
        F::update(self.belief, &C::loss(&gain), &[certain]);
        Some(())
    }
}
