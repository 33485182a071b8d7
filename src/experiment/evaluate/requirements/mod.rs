//! Requirements of air surveillance in a job that judges tracks.

mod fields;
mod kinds;
mod presets;
mod run;
mod spec;

pub use fields::FIELD;
pub use run::{Held, HeldSubject, RequirementsReport, hold};
pub use spec::RequirementsSpec;
