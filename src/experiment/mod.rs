//! Whole jobs, still pure: from a checked request and loaded datasets to a result, its artefacts and its warnings.
//!
//! `plan` checks a request and says which inputs it needs; the caller loads them; `run` does the work.
//! No clock, file, thread or network: time is measured and bytes are stored by whoever calls.

mod associate;
pub mod campaign;
pub mod catalogue;
mod correlate;
mod evaluate;
mod files;
mod group;
mod input;
pub mod observer;
pub mod plan;
pub mod presets;
mod request;
pub mod run;

pub use associate::gates;
pub use files::text;
pub use input::known as known_data;
pub use request::job_shape;
