//! Evaluation jobs as `trackloom run` gets them: a request in JSON, and files as texts.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::{Observer, Silent};
use trackloom_domain::experiment::{Input, JobKind, Outcome, RunError, Source, plan, run};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::fault::Fault;

/// Files as texts of one format; each is called by its number.
pub struct Texts {
    pub format: &'static str,
    texts: Vec<String>,
}

impl Texts {
    pub fn of(format: &'static str) -> Texts {
        Texts {
            format,
            texts: Vec::new(),
        }
    }

    pub fn dataset(&mut self, text: &str) -> Value {
        self.texts.push(text.to_owned());
        json!({"source": "dataset", "dataset_id": (self.texts.len() - 1).to_string()})
    }

    pub fn judge(&self, body: &Value) -> Result<Outcome, Vec<Fault>> {
        self.run(JobKind::Evaluate, body)
    }

    /// Plans the request, reads what it names, and runs it.
    pub fn run(&self, kind: JobKind, body: &Value) -> Result<Outcome, Vec<Fault>> {
        match self.run_watched(kind, body, &mut Silent) {
            Ok(outcome) => Ok(outcome),
            Err(RunError::Faults(faults)) => Err(faults),
            Err(RunError::Stopped) => panic!("nobody stopped it"),
        }
    }

    /// The same under an observer.
    pub fn run_watched(
        &self,
        kind: JobKind,
        body: &Value,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, RunError> {
        let plan = plan(kind, body)?;
        let mut inputs = Vec::new();
        for input in &plan.inputs {
            let Source::Dataset { dataset_id, .. } = &input.source else {
                panic!("no job is named")
            };
            let options = ReadOptions {
                kind: Some(input.role),
                ..ReadOptions::default()
            };
            let mut bytes = self.texts[dataset_id.parse::<usize>().unwrap()].as_bytes();
            let dataset = (format_named(self.format).unwrap().read)(&mut bytes, &options)?.dataset;
            inputs.push(Some(Input {
                dataset,
                sensors: Vec::new(),
                sha256: String::new(),
            }));
        }
        run(&plan, inputs, observer)
    }
}
