//! Methods that a request chooses by name, ready to be built.

use crate::association::{ASSOCIATORS, BuildAssociator};
use crate::correlation::fusion::{BuildFusion, FUSIONS};
use crate::correlation::grouping::{BuildGrouper, GROUPERS};
use crate::correlation::{BuildCorrelator, CORRELATORS};
use crate::evaluation::metrics::{BuildMetric, METRICS};
use crate::filtering::{AUTO, AnyFilter, FILTER_KIND, FILTERS};
use crate::math::rng::Seed;
use crate::model::space::Space;
use crate::registry::{self, Method};
use crate::tracking::{BuildTracker, Initiation, Lifecycle, TRACKERS, Undetected};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};

/// A method of a table with its checked parameters. It was built once when it was read, so it can be built again.
pub struct Choice<Build: 'static> {
    method: &'static Method<Build>,
    parameters: Value,
}

const BUILT_BEFORE: &str = "it was built when the request was read";

impl<Build> Choice<Build> {
    pub fn name(&self) -> &'static str {
        self.method.name
    }

    /// Takes the method that the field `tag` names, if `build` succeeds.
    fn read<'de, D: Deserializer<'de>, T>(
        deserializer: D,
        tag: &str,
        methods: &'static [Method<Build>],
        build: impl Fn(&Build, &Value) -> serde_json::Result<T>,
    ) -> Result<Self, D::Error> {
        let parameters = Value::deserialize(deserializer)?;
        let method = find(methods, &parameters, tag).map_err(D::Error::custom)?;
        build(&method.build, &parameters).map_err(D::Error::custom)?;
        Ok(Choice { method, parameters })
    }
}

fn find<Build>(
    methods: &'static [Method<Build>],
    parameters: &Value,
    tag: &str,
) -> Result<&'static Method<Build>, String> {
    methods
        .iter()
        .find(|method| parameters[tag] == method.name)
        .ok_or_else(|| format!("no {tag} of the table"))
}

impl<T: ?Sized> Choice<fn(&Value, Seed) -> serde_json::Result<Box<T>>> {
    /// With the seed of its random choices.
    pub fn build(&self, seed: Seed) -> Box<T> {
        (self.method.build)(&self.parameters, seed).expect(BUILT_BEFORE)
    }
}

impl<T: ?Sized> Choice<fn(&Value) -> serde_json::Result<Box<T>>> {
    /// As its parameters say.
    pub fn build(&self) -> Box<T> {
        (self.method.build)(&self.parameters).expect(BUILT_BEFORE)
    }
}

impl<Build> Clone for Choice<Build> {
    fn clone(&self) -> Self {
        Choice {
            method: self.method,
            parameters: self.parameters.clone(),
        }
    }
}

impl<Build> PartialEq for Choice<Build> {
    fn eq(&self, other: &Self) -> bool {
        self.parameters == other.parameters
    }
}

/// For building a method to see whether it can be.
const ANY_SEED: Seed = Seed { seed: 0, run: 0 };

impl<'de> Deserialize<'de> for Choice<BuildAssociator> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Choice::read(deserializer, "method", ASSOCIATORS, |build, parameters| {
            build(parameters, ANY_SEED)
        })
    }
}

impl<'de> Deserialize<'de> for Choice<BuildGrouper> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Choice::read(deserializer, "method", GROUPERS, |build, parameters| {
            build(parameters, ANY_SEED)
        })
    }
}

impl<'de> Deserialize<'de> for Choice<BuildCorrelator> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Choice::read(deserializer, "method", CORRELATORS, |build, parameters| {
            build(parameters, ANY_SEED)
        })
    }
}

impl<'de> Deserialize<'de> for Choice<BuildFusion> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Choice::read(deserializer, "method", FUSIONS, |build, parameters| {
            build(parameters)
        })
    }
}

impl<'de> Deserialize<'de> for Choice<BuildMetric> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Choice::read(deserializer, "metric", METRICS, |build, parameters| {
            build(parameters)
        })
    }
}

/// A filter with the name by which it is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedFilter {
    pub filter: AnyFilter,
    pub name: &'static str,
}

impl NamedFilter {
    /// The same for targets of this space.
    #[must_use]
    pub fn within(self, space: Space) -> Self {
        NamedFilter {
            filter: self.filter.within(space),
            ..self
        }
    }
}

impl<'de> Deserialize<'de> for NamedFilter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let parameters = Value::deserialize(deserializer)?;
        let method = find(FILTERS, &parameters, "method").map_err(D::Error::custom)?;
        Ok(NamedFilter {
            filter: (method.build)(&parameters).map_err(D::Error::custom)?,
            name: method.name,
        })
    }
}

/// The filter that a request asks for.
#[expect(clippy::large_enum_variant, reason = "a request has one")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FilterChoice {
    /// The one that suits what is reported.
    Auto,
    Named(NamedFilter),
}

impl<'de> Deserialize<'de> for FilterChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let parameters = Value::deserialize(deserializer)?;
        if parameters["method"] == AUTO {
            return Ok(FilterChoice::Auto);
        }
        NamedFilter::deserialize(parameters)
            .map(FilterChoice::Named)
            .map_err(D::Error::custom)
    }
}

/// A filter with its defaults, as a request would say it.
pub fn filter_named(method: &str) -> Value {
    registry::check_field(
        &json!({"method": method}),
        &FILTER_KIND,
        "",
        &mut Vec::new(),
    )
}

/// A tracker, and gate and life cycle of its tracks.
#[derive(Debug, Clone)]
pub struct TrackerSpec {
    pub build: BuildTracker,
    pub lifecycle: Lifecycle,
    pub undetected: Option<Undetected>,
    /// Whether the request leaves the speed open that new tracks allow for.
    pub leaves_speed_open: bool,
    /// Whether it leaves open how many detections of how many scans confirm a track.
    pub leaves_hits_open: bool,
    /// Whether recordings of a volume are tracked in the plane.
    pub stays_flat: bool,
}

impl<'de> Deserialize<'de> for TrackerSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        let lifecycle = Lifecycle::deserialize(&value).map_err(D::Error::custom)?;
        let leaves_speed_open = match lifecycle.initiation {
            Initiation::OnePoint | Initiation::MultiScan(_) => {
                value.get("initial_speed_sigma_mps").is_none()
            }
            Initiation::TwoPoint { .. } => value.pointer("/initiation/max_speed_mps").is_none(),
            Initiation::Truth { .. } => false,
        };
        let method = find(TRACKERS, &value, "method").map_err(D::Error::custom)?;
        let undetected = value.get("undetected").map(Undetected::deserialize);
        Ok(TrackerSpec {
            build: method.build,
            lifecycle,
            undetected: undetected.transpose().map_err(D::Error::custom)?,
            leaves_speed_open,
            leaves_hits_open: value.get("confirm_hits").is_none(),
            stays_flat: value["space"] == "plane",
        })
    }
}

/// How a job tracks.
#[derive(Clone, Deserialize)]
pub struct TrackingSpec {
    pub associator: Choice<BuildAssociator>,
    pub filter: FilterChoice,
    pub tracker: TrackerSpec,
}

/// How a job tracks that may be given its tracks instead.
#[derive(Clone, Deserialize)]
pub struct OptionalTracking {
    associator: Option<Choice<BuildAssociator>>,
    filter: Option<FilterChoice>,
    tracker: Option<TrackerSpec>,
}

impl OptionalTracking {
    /// `None` of tracks that are there already.
    pub fn whole(&self) -> Option<TrackingSpec> {
        Some(TrackingSpec {
            associator: self.associator.clone()?,
            filter: self.filter?,
            tracker: self.tracker.clone()?,
        })
    }
}
