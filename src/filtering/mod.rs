//! Filters: how a belief about a target is predicted to the time of a scan, compared with reports and updated with weighted
//! detections. A filter is a motion model and a way through sensing models; it knows neither by name.

use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::sensing::{MeasurementModel, Sensing};
use crate::model::space::Space;
use crate::model::state::GaussianState;
use crate::registry::{Field, Kind, Method, Object, Union, default, number, optional, variant};
use bearing_only::BearingOnly;
use climbing::Climbing;
use gaussian::GaussianFilter;
use imm::{Models, RangeParametrised};
use motions::{AnyMotion, MOTION_KIND, MotionSpec};
use nalgebra::SVector;
use serde::Deserialize;

pub mod bearing_only;
pub mod climbing;
pub mod converted;
pub mod expected;
pub mod extended;
pub mod gaussian;
pub mod imm;
pub mod kalman;
mod mixture;
pub mod motions;
mod smoothing;
pub mod unscented;

pub use expected::{Expected, Way};

/// A filter of targets whose kinematics have `K` variables: coordinates, then their rates. What it believes is its own.
pub trait Filter<const K: usize>: Copy + Send + 'static {
    /// What it holds of one target.
    type Belief: Copy + Send;
    /// What a time does to every belief.
    type Step: Copy + Send;
    /// What a detection changes, were it certain.
    type Change: Copy + Send;
    /// What uncertainty a belief loses by a certain detection, whichever it is.
    type Loss: Copy + Send;

    fn step(&self, dt_s: f64) -> Self::Step;

    fn predict(step: &Self::Step, belief: &mut Self::Belief);

    /// Does the work with the way of comparing beliefs with these reports; `None` where they say nothing of such targets.
    fn correct<W: WithCorrector<Self, K>>(
        &self,
        report: &MeasurementModel,
        work: W,
    ) -> Option<W::Output>;

    /// The weights of the detections and of none sum to 1.
    fn update(belief: &mut Self::Belief, loss: &Self::Loss, detections: &[Weighted<Self::Change>]);

    /// What a belief loses on average over detections that lose it different amounts: one loss each, in the same order.
    fn mean_loss(losses: &[Self::Loss], detections: &[Weighted<Self::Change>]) -> Self::Loss;

    /// The belief of a target of which these kinematics are known.
    fn begin(&self, kinematics: &GaussianState<K>) -> Self::Belief;

    /// The same where one of several parts is true, with equal probability; `whole` has the moments of all. A filter of one
    /// Gaussian takes the whole, and so do all where there are no parts.
    fn begin_among(&self, whole: &GaussianState<K>, _parts: &[GaussianState<K>]) -> Self::Belief {
        self.begin(whole)
    }

    fn kinematics(belief: &Self::Belief) -> GaussianState<K>;

    /// The belief in the light of what came after: `next` is what is believed of the target after this step, in that light.
    fn smooth(step: &Self::Step, belief: &Self::Belief, next: &Self::Belief) -> Self::Belief;

    /// How probable each of several models of motion is; of a single one nothing is told.
    fn mode_probabilities(_belief: &Self::Belief) -> &[f64] {
        &[]
    }

    /// The normalised innovation squared of a detection at this squared distance.
    #[inline(always)]
    fn fit(_change: &Self::Change, squared_distance: f64) -> f64 {
        squared_distance
    }

    /// Appends all numbers of a belief.
    fn pack(belief: &Self::Belief, packed: &mut Vec<f64>);

    /// What [`Filter::pack`] wrote; `None` for anything else.
    fn unpack(packed: &[f64]) -> Option<Self::Belief>;

    /// Variance of a rate at the end of `dt_s` around the mean rate of that time, as far as the motion's noise goes.
    fn rate_variance(&self, dt_s: f64) -> f64;

    /// The same around the mean rate of the time before, of the most restless of its models, with what these do without noise to a
    /// target of this speed.
    fn most_rate_variance(&self, dt_s: f64, speed_mps: f64) -> f64;

    /// As of [`crate::model::motion::Motion::white_acceleration`]; of a filter of one Gaussian alone.
    fn white_acceleration(&self) -> Option<f64> {
        None
    }

    /// Standard deviation of the rates of a new track, where the tracker says `speed_sigma_mps` of velocities.
    fn rate_sigma(&self, speed_sigma_mps: f64) -> f64;
}

/// How a filter compares its beliefs with reports of `D` values.
pub trait Corrector<F: Filter<K>, const K: usize, const D: usize> {
    /// What the sensor reports.
    type Sensing: Sensing<K, D>;
    /// What makes a change of an innovation.
    type Gain;
    /// The value that is an angle, if there is one.
    const ANGLE: Option<usize> = <Self::Sensing as Sensing<K, D>>::ANGLE;
    /// Whether reports are expected in several regions, [`Corrector::regions`], instead of the one around what is expected.
    const HAS_REGIONS: bool = false;

    fn sensing(&self) -> &Self::Sensing;

    /// A report as a point of the measurement space; `None` for one of another kind.
    fn read(&self, report: &Measurement, own: &Own) -> Option<SVector<f64, D>> {
        self.sensing().read(report, own)
    }

    /// What should be reported of a target. `None` when S is not positive definite.
    fn expect(&self, belief: &F::Belief) -> Option<(Expected<D>, Self::Gain)>;

    /// The same of a report that has a noise and a time of its own. The target goes on as it is between the times of the scan and
    /// of the report: what the motion's noise does in that time, mostly less than half a scan, is left out.
    fn expect_own(&self, belief: &F::Belief, own: &Own) -> Option<(Expected<D>, Self::Gain)>;

    /// Where reports are expected.
    fn regions(_gain: &Self::Gain) -> &[Expected<D>] {
        &[]
    }

    fn change(gain: &Self::Gain, innovation: &SVector<f64, D>) -> F::Change;

    /// The same, and ln of the density of reports there.
    #[inline(always)]
    fn assess(
        gain: &Self::Gain,
        expected: &Expected<D>,
        innovation: &SVector<f64, D>,
        squared_distance: f64,
    ) -> (F::Change, f64) {
        (
            Self::change(gain, innovation),
            expected.gaussian.log_density(squared_distance),
        )
    }

    fn loss(gain: &Self::Gain) -> F::Loss;

    /// ln of how much of the space in which clutter is stated a unit of the measurement space covers.
    #[inline(always)]
    fn log_clutter_scale(&self, expected: &SVector<f64, D>) -> f64 {
        self.sensing().log_clutter_scale(expected)
    }

    /// The same of a report that has something of its own.
    fn log_clutter_scale_own(&self, expected: &SVector<f64, D>, own: &Own) -> f64 {
        let sensing = self.sensing().with_own(own);
        sensing.log_clutter_scale(expected)
    }

    /// The kinematics that one report alone tells, if it says where the target is; at the time of the report.
    fn locate(
        &self,
        report: &SVector<f64, D>,
        rate_sigma: f64,
        own: &Own,
    ) -> Option<GaussianState<K>> {
        let sensing = self.sensing().with_own(own);
        sensing.locate(report, rate_sigma)
    }

    /// As of [`crate::model::sensing::Sensing::parts`], for a filter that begins among several.
    fn parts(
        &self,
        _report: &SVector<f64, D>,
        _rate_sigma: f64,
        _own: &Own,
    ) -> Vec<GaussianState<K>> {
        Vec::new()
    }
}

/// Work that is compiled for each kind of report.
pub trait WithCorrector<F: Filter<K>, const K: usize> {
    type Output;

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) -> Self::Output;
}

/// The change by a detection, and the weight of that detection.
#[derive(Debug, Clone, Copy)]
pub struct Weighted<C> {
    pub change: C,
    pub weight: f64,
}

/// A filter that was chosen by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyFilter {
    /// Of places in the plane.
    Plane(PlaceFilter),
    /// Of places in space.
    Volume(PlaceFilter),
    /// Of places in the plane, where a bearing may start a track at several ranges.
    Ranges(RangeParametrised),
    /// Of directions.
    Bearing(BearingOnly),
}

/// A filter of places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceFilter {
    pub movement: Movement,
    pub way: Way,
    pub reports: Reports,
    /// How z and its rate change in space, where the movement is of the horizontal.
    pub vertical: ConstantVelocity,
}

/// How targets move.
#[expect(clippy::large_enum_variant, reason = "a filter has one")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Movement {
    Single(AnyMotion),
    /// By one of several motions at a time.
    Several(Models),
}

/// Which reports a filter of places uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reports {
    Positions,
    /// Ranges and bearings are turned into positions first.
    Converted,
    All,
}

/// Work that is compiled for each filter.
pub trait WithFilter {
    type Output;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Self::Output;

    fn in_volume<F: Filter<6>>(self, filter: F) -> Self::Output;

    fn of_bearings<F: Filter<2>>(self, filter: F) -> Self::Output;
}

impl PlaceFilter {
    fn with_in_plane<W: WithFilter>(self, work: W) -> W::Output {
        let PlaceFilter { way, reports, .. } = self;
        // Every filter compiles all that tracks: only the usual motion has one of its own, the others share one a size of state.
        match self.movement {
            Movement::Several(models) => models.with(way, reports, work),
            Movement::Single(AnyMotion::ConstantVelocity(motion)) => {
                work.in_plane(GaussianFilter::<_, 4, 4>::new(motion, way, reports))
            }
            Movement::Single(
                motion @ (AnyMotion::CoordinatedTurn(_) | AnyMotion::OrnsteinUhlenbeck(_)),
            ) => work.in_plane(GaussianFilter::<AnyMotion, 4, 4>::new(motion, way, reports)),
            Movement::Single(motion @ AnyMotion::UnknownTurn(_)) => {
                work.in_plane(GaussianFilter::<AnyMotion, 5, 4>::new(motion, way, reports))
            }
            Movement::Single(
                motion @ (AnyMotion::ConstantAcceleration(_) | AnyMotion::Singer(_)),
            ) => work.in_plane(GaussianFilter::<AnyMotion, 6, 4>::new(motion, way, reports)),
        }
    }

    /// In space all but the usual motion share one instance: several models, of which there may be one.
    fn with_in_volume<W: WithFilter>(self, work: W) -> W::Output {
        let (way, reports) = (self.way, self.reports);
        let models = match self.movement {
            Movement::Several(models) => models,
            Movement::Single(motion) => {
                let climbing = Climbing {
                    motion,
                    vertical: self.vertical,
                };
                if let Some(motion) = climbing.as_velocity() {
                    return work.in_volume(GaussianFilter::<_, 6, 6>::new(motion, way, reports));
                }
                Models::single(motion)
            }
        };
        models.with_in_volume(self.vertical, (way, reports), work)
    }
}

impl AnyFilter {
    pub fn with<W: WithFilter>(&self, work: W) -> W::Output {
        match *self {
            AnyFilter::Bearing(filter) => work.of_bearings(filter.build()),
            AnyFilter::Ranges(filter) => work.in_plane(filter),
            AnyFilter::Plane(filter) => filter.with_in_plane(work),
            AnyFilter::Volume(filter) => filter.with_in_volume(work),
        }
    }

    /// The Kalman filter of positions, with nearly constant velocity.
    pub fn kalman(process_noise_m2ps3: f64) -> Self {
        AnyFilter::Plane(PlaceFilter {
            movement: Movement::Single(AnyMotion::ConstantVelocity(ConstantVelocity {
                spectral_density: process_noise_m2ps3,
            })),
            way: Way::Line,
            reports: Reports::Positions,
            vertical: vertical(None),
        })
    }

    /// The same filter for targets of this space; a filter of directions stays one.
    #[must_use]
    pub fn within(self, space: Space) -> Self {
        match (self, space) {
            (AnyFilter::Plane(filter), Space::Volume) => AnyFilter::Volume(filter),
            (AnyFilter::Volume(filter), Space::Plane) => AnyFilter::Plane(filter),
            (other, _) => other,
        }
    }

    /// Of one of places.
    fn places(&self) -> Option<&PlaceFilter> {
        match self {
            AnyFilter::Plane(filter) | AnyFilter::Volume(filter) => Some(filter),
            AnyFilter::Ranges(_) | AnyFilter::Bearing(_) => None,
        }
    }

    /// The filter that starts tracks at several ranges and is this one otherwise. `None` where its targets have more than a
    /// position and a velocity, or several motions, or are in space.
    pub fn at_ranges(&self) -> Option<Self> {
        let AnyFilter::Plane(PlaceFilter {
            movement: Movement::Single(motion),
            way,
            reports,
            ..
        }) = *self
        else {
            return None;
        };
        let ranges = RangeParametrised {
            motion,
            way,
            reports,
        };
        (!motion.has_more_than_kinematics()).then_some(AnyFilter::Ranges(ranges))
    }

    /// Whether the kinematics of a target say all that the filter believes of it.
    pub fn is_known_by_kinematics(&self) -> bool {
        match self.places().map(|filter| &filter.movement) {
            Some(Movement::Single(motion)) => !motion.has_more_than_kinematics(),
            Some(Movement::Several(_)) => false,
            None => !matches!(self, AnyFilter::Ranges(_)),
        }
    }

    /// Where there are several.
    pub fn models(&self) -> Option<&Models> {
        match &self.places()?.movement {
            Movement::Several(models) => Some(models),
            Movement::Single(_) => None,
        }
    }

    pub fn uses_ranges(&self) -> bool {
        self.uses(&[Reports::Converted, Reports::All])
    }

    pub fn uses_range_rates(&self) -> bool {
        self.uses(&[Reports::All])
    }

    /// Of the tracks that it makes.
    pub fn space(&self) -> Space {
        match self {
            AnyFilter::Bearing(_) => Space::Bearing,
            AnyFilter::Plane(_) | AnyFilter::Ranges(_) => Space::Plane,
            AnyFilter::Volume(_) => Space::Volume,
        }
    }

    fn uses(&self, any_of: &[Reports]) -> bool {
        match self {
            AnyFilter::Plane(PlaceFilter { reports, .. })
            | AnyFilter::Volume(PlaceFilter { reports, .. })
            | AnyFilter::Ranges(RangeParametrised { reports, .. }) => any_of.contains(reports),
            AnyFilter::Bearing(_) => false,
        }
    }
}

/// An entry of the table: the build takes checked parameters.
pub type FilterMethod = Method<fn(&serde_json::Value) -> Result<AnyFilter, serde_json::Error>>;

/// Every filter.
pub const FILTERS: &[FilterMethod] = &[
    kalman::METHOD,
    extended::METHOD,
    unscented::METHOD,
    converted::METHOD,
    imm::METHOD,
    bearing_only::METHOD,
];

/// The name under which the filter is chosen by what the sensors report.
pub const AUTO: &str = "auto";

static AUTO_PARAMETERS: Object = Object {
    name: "AutoFilter",
    summary: "The filter that suits what is reported, with its defaults: kalman for positions, unscented for ranges and bearings and for sensors of several kinds, bearing_only for bearings alone.",
    fields: &[],
};

pub static FILTER: Union = Union {
    name: "Filter",
    summary: "How a track is predicted and updated.",
    tag: "method",
    variants: || {
        [variant(AUTO, &AUTO_PARAMETERS)]
            .into_iter()
            .chain(FILTERS.iter().map(Method::variant))
            .collect()
    },
};

/// The field kind of a filter choice.
pub static FILTER_KIND: Kind = Kind::Union(&FILTER);

const PROCESS_NOISE: Field = default(
    "process_noise_m2ps3",
    "Spectral density q of the white-noise acceleration; the velocity wanders by about sqrt(q·T) in T seconds. An acceleration that is piecewise constant over scans of T s with sigma_a is about q = sigma_a²·T; sigma_a lies between half of and the whole largest acceleration.",
    number(0.0, 1e9, "m²/s³"),
    "1.0",
);
const MOTION: Field = optional(
    "motion",
    "How targets move; when absent, with nearly constant velocity and process_noise_m2ps3.",
    MOTION_KIND,
);
const VERTICAL: Field = optional(
    "vertical_process_noise_m2ps3",
    "The same of the vertical where targets are tracked in space, whatever they do in the horizontal; 0.01 when absent: aircraft climb calmly. Constant acceleration and Singer's model are the same on all three axes, and do not use it.",
    number(0.0, 1e9, "m²/s³"),
);
/// The parameters of every filter of places.
const MOTION_FIELDS: [Field; 3] = [PROCESS_NOISE, MOTION, VERTICAL];

/// Nearly constant velocity up or down, with what a request says of it.
fn vertical(process_noise_m2ps3: Option<f64>) -> ConstantVelocity {
    const CALM_M2PS3: f64 = 0.01;
    ConstantVelocity {
        spectral_density: process_noise_m2ps3.unwrap_or(CALM_M2PS3),
    }
}

/// How targets move, of a filter of places.
#[derive(Deserialize)]
struct MotionFields {
    process_noise_m2ps3: f64,
    motion: Option<MotionSpec>,
    vertical_process_noise_m2ps3: Option<f64>,
}

/// A filter in the plane with the motion that its checked parameters say.
fn in_plane(
    spec: &serde_json::Value,
    way: Way,
    reports: Reports,
) -> Result<AnyFilter, serde_json::Error> {
    let fields = MotionFields::deserialize(spec)?;
    let motion = fields.motion.map_or(
        AnyMotion::ConstantVelocity(ConstantVelocity {
            spectral_density: fields.process_noise_m2ps3,
        }),
        AnyMotion::from,
    );
    Ok(AnyFilter::Plane(PlaceFilter {
        movement: Movement::Single(motion),
        way,
        reports,
        vertical: vertical(fields.vertical_process_noise_m2ps3),
    }))
}
