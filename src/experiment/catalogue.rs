//! What can be asked for: the families of methods and the bodies of requests, for the API, the forms and the document.

use super::request::fields;
use crate::association::ASSOCIATOR;
use crate::correlation::CORRELATOR;
use crate::correlation::grouping::GROUPER;
use crate::filtering::FILTER;
use crate::registry::{Object, Union, Variant, standalone_schema};
use serde_json::{Value, json};

/// A family of exchangeable methods.
pub struct Family {
    pub name: &'static str,
    union: &'static Union,
}

/// Every family, in the order in which a job uses them.
pub const FAMILIES: &[Family] = &[
    Family {
        name: "associator",
        union: &ASSOCIATOR,
    },
    Family {
        name: "filter",
        union: &FILTER,
    },
    Family {
        name: "grouper",
        union: &GROUPER,
    },
    Family {
        name: "correlator",
        union: &CORRELATOR,
    },
];

impl Family {
    pub fn summary(&self) -> &'static str {
        self.union.summary
    }

    /// The methods: tag and parameters of each.
    pub fn methods(&self) -> Vec<Variant> {
        (self.union.variants)()
    }
}

/// A family as JSON: each method with its summary and the JSON Schema of its parameters.
pub fn describe(family: &Family) -> Value {
    let method = |variant: &Variant| json!({"name": variant.tag, "summary": variant.object.summary, "parameters": standalone_schema(variant.object)});
    json!({"family": family.name, "summary": family.summary(), "methods": family.methods().iter().map(method).collect::<Vec<_>>()})
}

/// The settings of a sensor, as uploads and requests give them.
pub const fn sensor_settings() -> &'static Object {
    &fields::SENSOR_SETTINGS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{JobKind, request_object};
    use crate::registry::{Field, Kind, Presence, check_field};

    /// Visits every field of an object, at every depth.
    fn visit(object: &'static Object, seen: &mut dyn FnMut(&'static Object, &'static Field)) {
        for field in object.fields {
            seen(object, field);
            visit_kind(&field.kind, seen);
        }
    }

    fn visit_kind(kind: &'static Kind, seen: &mut dyn FnMut(&'static Object, &'static Field)) {
        match kind {
            Kind::Object(object) => visit(object, seen),
            Kind::Union(union) => (union.variants)()
                .iter()
                .for_each(|variant| visit(variant.object, seen)),
            Kind::List { item, .. } => visit_kind(item, seen),
            _ => {}
        }
    }

    #[test]
    fn every_default_in_the_tables_is_json_that_passes_its_own_check() {
        let mut defaults = 0;
        for kind in JobKind::ALL {
            visit(request_object(kind), &mut |object, field| {
                assert!(
                    !field.summary.is_empty(),
                    "{}.{} has no summary",
                    object.name,
                    field.name
                );
                if let Presence::Default(text) = field.presence {
                    let value = serde_json::from_str(text)
                        .unwrap_or_else(|error| panic!("{}.{}: {error}", object.name, field.name));
                    let mut faults = Vec::new();
                    check_field(&value, &field.kind, "", &mut faults);
                    assert_eq!(faults, [], "{}.{}", object.name, field.name);
                    defaults += 1;
                }
            });
        }
        assert!(defaults > 20, "only {defaults} defaults seen");
    }

    #[test]
    fn a_method_with_its_defaults_can_be_built() {
        for method in crate::association::ASSOCIATORS {
            let parameters = crate::registry::check(&serde_json::json!({}), method.parameters);
            let seed = crate::math::rng::Seed { seed: 1, run: 0 };
            assert!(
                (method.build)(&parameters.unwrap(), seed).is_ok(),
                "{}",
                method.name
            );
        }
        for method in crate::filtering::FILTERS {
            let parameters = crate::registry::check(&serde_json::json!({}), method.parameters);
            assert!(
                (method.build)(&parameters.unwrap()).is_ok(),
                "{}",
                method.name
            );
        }
    }
}
