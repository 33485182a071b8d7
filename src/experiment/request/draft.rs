//! A request on its way to a job: what its table has checked, with the faults that were found so far. What is right in it can be
//! read however much else is wrong, so that one answer tells all faults.

use super::names::check_names;
use super::preset_source;
use crate::experiment::job::{Cost, InputRequest, Job};
use crate::model::fault::Fault;
use crate::registry::{self, Kind, Object};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::sync::Arc;

/// What the types of a request and its table have in common is held by a test.
const AGREED: &str = "the table of a request checks all that its type reads";

/// A request that its table has checked.
pub struct Draft {
    pub(super) spec: Value,
    pub(super) faults: Vec<Fault>,
}

/// A request that was parsed.
pub struct Planned {
    /// As normalised.
    pub spec: Value,
    pub seed: u32,
    /// What must be loaded before it runs.
    pub inputs: Vec<InputRequest>,
    pub cost: Cost,
    pub job: Arc<dyn Job>,
}

#[derive(Deserialize)]
struct Seeded {
    seed: u32,
}

impl Draft {
    /// Checks the body of a request by its table and fills in the defaults, those of its preset first.
    ///
    /// # Errors
    /// The faults of a body that is no object.
    pub fn new(body: &Value, object: &'static Object) -> Result<Draft, Vec<Fault>> {
        let mut faults = Vec::new();
        let body = preset_source::with_settings(object, body);
        let spec = registry::check_into(&body, object, &mut faults);
        if !spec.is_object() {
            return Err(faults);
        }
        check_names(&spec, &mut faults);
        Ok(Draft { spec, faults })
    }

    /// Whether a field is given.
    pub fn has(&self, name: &str) -> bool {
        self.spec.get(name).is_some()
    }

    /// What stands at a JSON pointer.
    pub fn at(&self, pointer: &str) -> Option<&Value> {
        self.spec.pointer(pointer)
    }

    pub fn text_at(&self, pointer: &str) -> Option<&str> {
        self.at(pointer).and_then(Value::as_str)
    }

    pub fn count_at(&self, pointer: &str) -> Option<u64> {
        self.at(pointer).and_then(Value::as_u64)
    }

    /// How many entries a list has.
    pub fn length_of(&self, name: &str) -> Option<usize> {
        self.spec.get(name).and_then(Value::as_array).map(Vec::len)
    }

    /// A part of the request, where it is there and right.
    pub fn read<T: DeserializeOwned>(&self, pointer: &str) -> Option<T> {
        self.at(pointer)
            .and_then(|value| T::deserialize(value).ok())
    }

    /// Sets a field.
    pub fn put(&mut self, name: &str, value: Value) {
        self.spec[name] = value;
    }

    /// Fills in a field, from JSON text, where it is absent.
    pub fn put_default(&mut self, name: &str, text: &str, kind: &'static Kind) {
        if !self.has(name) {
            let value = serde_json::from_str(text).expect("the defaults are JSON");
            self.put(
                name,
                registry::check_field(&value, kind, "", &mut Vec::new()),
            );
        }
    }

    /// Adds faults.
    pub fn add(&mut self, faults: impl IntoIterator<Item = Fault>) {
        self.faults.extend(faults);
    }

    pub fn fault_count(&self) -> usize {
        self.faults.len()
    }

    /// Adds a fault for each of these fields that is given.
    pub fn refuse(&mut self, names: &[&str], why: &str) {
        for name in names {
            if self.has(name) {
                let detail = format!("'{name}' {why}");
                self.add([Fault::new(format!("/{name}"), "conflict", detail)]);
            }
        }
    }

    /// Makes the job of the typed request.
    ///
    /// # Errors
    /// All faults that were found.
    pub fn finish<T: DeserializeOwned, J: Job>(
        self,
        inputs: Vec<InputRequest>,
        cost: Cost,
        make: impl FnOnce(T) -> J,
    ) -> Result<Planned, Vec<Fault>> {
        if !self.faults.is_empty() {
            return Err(self.faults);
        }
        let Seeded { seed } = parse(&self.spec);
        Ok(Planned {
            seed,
            inputs,
            cost,
            job: Arc::new(make(parse(&self.spec))),
            spec: self.spec,
        })
    }

    /// The checked request.
    ///
    /// # Errors
    /// All faults that were found.
    pub fn into_spec(self) -> Result<Value, Vec<Fault>> {
        if self.faults.is_empty() {
            Ok(self.spec)
        } else {
            Err(self.faults)
        }
    }

    /// The typed request, where nothing is wrong with it.
    ///
    /// # Errors
    /// All faults, with those that `more` finds.
    pub fn typed<T: DeserializeOwned>(
        &mut self,
        more: impl FnOnce(&Draft) -> Vec<Fault>,
    ) -> Result<T, Vec<Fault>> {
        if self.faults.is_empty() {
            return Ok(parse(&self.spec));
        }
        let found = more(self);
        self.add(found);
        Err(std::mem::take(&mut self.faults))
    }
}

/// A checked value as its type.
pub fn parse<T: DeserializeOwned>(spec: &Value) -> T {
    T::deserialize(spec).expect(AGREED)
}

/// The defaults of a table as their type.
pub fn defaults_of<T: DeserializeOwned>(object: &'static Object) -> T {
    parse(&registry::check(&json!({}), object).expect("every field has a default"))
}
