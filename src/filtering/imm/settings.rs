//! The models of an IMM as a request names them.

use super::{Imm, Interacting, Mixing};
use crate::filtering::climbing::Climbing;
use crate::filtering::motions::{
    ACCELERATION_FIELDS, AnyMotion, MotionSpec, ORNSTEIN_UHLENBECK_FIELDS, SINGER_FIELDS,
    TURN_FIELDS, UNKNOWN_TURN_FIELDS,
};
use crate::filtering::unscented::Unscented;
use crate::filtering::{
    AnyFilter, FilterMethod, Movement, PROCESS_NOISE, PlaceFilter, Reports, VERTICAL, Way,
    WithFilter, vertical,
};
use crate::model::modes::MAX_MODES;
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::registry::{
    Field, Kind, Object, Union, default, joined, list, number, optional, variant,
};
use serde::Deserialize;
use serde::de::Error;

/// Models of a filter at the most.
pub const MAX_MODELS: usize = MAX_MODES;

pub const METHOD: FilterMethod = FilterMethod {
    name: "imm",
    parameters: &PARAMETERS,
    build: |spec| Wire::deserialize(spec).and_then(Wire::build),
};

/// One of the models, and how long it lasts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    pub motion: AnyMotion,
    /// Mean time until another model takes over.
    pub sojourn_s: f64,
    /// Of a new track, before all are brought to the sum 1; the share of time of the long run when `None`.
    pub initial_probability: Option<f64>,
}

/// Some models, at most [`MAX_MODELS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Models {
    models: [Model; MAX_MODELS],
    count: usize,
    pub mixing: Mixing,
}

impl Models {
    /// `None` without a model, and of more than there may be.
    pub fn new(given: &[Model], mixing: Mixing) -> Option<Self> {
        let first = *given.first()?;
        let mut models = [first; MAX_MODELS];
        models.get_mut(..given.len())?.copy_from_slice(given);
        Some(Models {
            models,
            count: given.len(),
            mixing,
        })
    }

    pub fn iter(&self) -> std::slice::Iter<'_, Model> {
        self.models[..self.count].iter()
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// The motion of a model; of one that there is not, that of the first.
    pub(super) fn motion(&self, mode: usize) -> &AnyMotion {
        &self.models[mode.min(MAX_MODELS - 1)].motion
    }

    pub fn sojourns_s(&self) -> Vec<f64> {
        self.iter().map(|model| model.sojourn_s).collect()
    }

    /// Of a new track.
    pub fn initial_probabilities(&self) -> [f64; MAX_MODELS] {
        let total_s: f64 = self.iter().map(|model| model.sojourn_s).sum();
        let mut probabilities = [0.0; MAX_MODELS];
        for (probability, model) in probabilities.iter_mut().zip(self.iter()) {
            let share = model.sojourn_s / total_s;
            *probability = model
                .initial_probability
                .unwrap_or(share)
                .max(super::LEAST_PROBABILITY);
        }
        let total: f64 = probabilities.iter().sum();
        probabilities.map(|probability| probability / total)
    }

    /// Does the work with the filter that is compiled for so many models of such sizes.
    pub(in crate::filtering) fn with<W: WithFilter>(
        self,
        way: Way,
        reports: Reports,
        work: W,
    ) -> W::Output {
        let is_small = self
            .iter()
            .all(|model| !model.motion.has_more_than_kinematics());
        if is_small && self.count <= 2 {
            work.in_plane(Imm::<2, 4>::new(self, way, reports))
        } else {
            work.in_plane(Imm::<MAX_MODELS, 6>::new(self, way, reports))
        }
    }

    /// The same in space, beside this vertical.
    pub(in crate::filtering) fn with_in_volume<W: WithFilter>(
        self,
        vertical: ConstantVelocity,
        (way, reports): (Way, Reports),
        work: W,
    ) -> W::Output {
        let climbing = |motion: &AnyMotion| Climbing {
            motion: *motion,
            vertical,
        };
        if self.count == 1 {
            work.in_volume(Interacting::<_, 1, 9, 6>::of_motions(
                self, climbing, way, reports,
            ))
        } else {
            work.in_volume(Interacting::<_, MAX_MODELS, 9, 6>::of_motions(
                self, climbing, way, reports,
            ))
        }
    }

    /// One model that lasts for ever.
    pub(in crate::filtering) fn single(motion: AnyMotion) -> Self {
        let model = Model {
            motion,
            sojourn_s: f64::INFINITY,
            initial_probability: Some(1.0),
        };
        Models {
            models: [model; MAX_MODELS],
            count: 1,
            mixing: Mixing::Unbiased,
        }
    }
}

static PARAMETERS: Object = Object {
    name: "ImmFilter",
    summary: "Interacting multiple models: a target moves by one of several models and changes between them; for targets that turn, climb or accelerate now and then.",
    fields: &[
        default(
            "models",
            "The models, 2 to 6; the first is the usual one. When absent, calm and restless flight of aircraft: two constant velocities.",
            list(&Kind::Union(&MODEL), 2, MAX_MODELS),
            r#"[{"model":"constant_velocity","process_noise_m2ps3":0.05},{"model":"constant_velocity","process_noise_m2ps3":20.0}]"#,
        ),
        default(
            "way",
            "How reports are compared with states: as by the filter of this name.",
            Kind::Choice(&["kalman", "extended", "unscented", "converted"]),
            r#""extended""#,
        ),
        default(
            "mixing",
            "What a model without accelerations or a turn rate lends one that has them: unbiased, what that one believes itself; or zero.",
            Kind::Choice(&["unbiased", "zero"]),
            r#""unbiased""#,
        ),
        VERTICAL,
    ],
};

const SOJOURN: [Field; 2] = [
    optional(
        "sojourn_s",
        "Mean time for which a target keeps to this model before it changes to another one; 100 for the first model and 20 for the others when absent.",
        number(0.1, 1e6, "s"),
    ),
    optional(
        "initial_probability",
        "Probability of this model in a new track; when absent, its share of the time in the long run. All of them are brought to the sum 1.",
        number(0.0, 1.0, ""),
    ),
];

/// The fields of a motion, and those of a model.
const fn of_model<const N: usize>(motion: &[Field]) -> [Field; N] {
    assert!(N == motion.len() + SOJOURN.len());
    joined(&[motion, &SOJOURN])
}

static CONSTANT_VELOCITY: Object = Object {
    name: "ConstantVelocityModel",
    summary: "Nearly constant velocity.",
    fields: &of_model::<3>(&[PROCESS_NOISE]),
};

static CONSTANT_ACCELERATION: Object = Object {
    name: "ConstantAccelerationModel",
    summary: "Nearly constant acceleration.",
    fields: &of_model::<4>(&ACCELERATION_FIELDS),
};

static COORDINATED_TURN: Object = Object {
    name: "CoordinatedTurnModel",
    summary: "Turn of a known rate.",
    fields: &of_model::<4>(&TURN_FIELDS),
};

static UNKNOWN_TURN: Object = Object {
    name: "UnknownTurnModel",
    summary: "Turn of an estimated rate.",
    fields: &of_model::<5>(&UNKNOWN_TURN_FIELDS),
};

static SINGER: Object = Object {
    name: "SingerModel",
    summary: "Accelerations that last for about maneuver_time_s.",
    fields: &of_model::<4>(&SINGER_FIELDS),
};

static ORNSTEIN_UHLENBECK: Object = Object {
    name: "OrnsteinUhlenbeckModel",
    summary: "Velocity that is pulled back to a mean.",
    fields: &of_model::<6>(&ORNSTEIN_UHLENBECK_FIELDS),
};

static MODEL: Union = Union {
    name: "ImmModel",
    summary: "A motion model, and how long a target keeps to it.",
    tag: "model",
    variants: || {
        vec![
            variant("constant_velocity", &CONSTANT_VELOCITY),
            variant("constant_acceleration", &CONSTANT_ACCELERATION),
            variant("coordinated_turn", &COORDINATED_TURN),
            variant("unknown_turn", &UNKNOWN_TURN),
            variant("singer", &SINGER),
            variant("ornstein_uhlenbeck", &ORNSTEIN_UHLENBECK),
        ]
    },
};

/// The parameters, checked.
#[derive(Deserialize)]
struct Wire {
    models: Vec<WireModel>,
    way: WireWay,
    mixing: WireMixing,
    vertical_process_noise_m2ps3: Option<f64>,
}

#[derive(Deserialize)]
struct WireModel {
    #[serde(flatten)]
    motion: MotionSpec,
    sojourn_s: Option<f64>,
    initial_probability: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum WireWay {
    Kalman,
    Extended,
    Unscented,
    Converted,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum WireMixing {
    Unbiased,
    Zero,
}

/// Of models beyond the first, which is where targets are most of the time.
const SOJOURN_S: f64 = 20.0;
const FIRST_SOJOURN_S: f64 = 100.0;

impl Wire {
    fn build(self) -> Result<AnyFilter, serde_json::Error> {
        let (way, reports) = match self.way {
            WireWay::Kalman => (Way::Line, Reports::Positions),
            WireWay::Extended => (Way::Line, Reports::All),
            WireWay::Unscented => (Way::Points(Unscented::default()), Reports::All),
            WireWay::Converted => (Way::Line, Reports::Converted),
        };
        let mixing = match self.mixing {
            WireMixing::Unbiased => Mixing::Unbiased,
            WireMixing::Zero => Mixing::Zero,
        };
        let models: Vec<Model> = self.models.into_iter().enumerate().map(resolved).collect();
        let models = Models::new(&models, mixing)
            .ok_or_else(|| serde_json::Error::custom("2 to 6 models"))?;
        Ok(AnyFilter::Plane(PlaceFilter {
            movement: Movement::Several(models),
            way,
            reports,
            vertical: vertical(self.vertical_process_noise_m2ps3),
        }))
    }
}

fn resolved((index, model): (usize, WireModel)) -> Model {
    let usual_s = if index == 0 {
        FIRST_SOJOURN_S
    } else {
        SOJOURN_S
    };
    Model {
        motion: model.motion.into(),
        sojourn_s: model.sojourn_s.unwrap_or(usual_s),
        initial_probability: model.initial_probability,
    }
}
