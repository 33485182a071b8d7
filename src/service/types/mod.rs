//! The wire types: what requests and answers look like in JSON and in the API document.
//!
//! Optional members are absent, never null. Unions are plain `oneOf` of named structs, each with a required member
//! whose type has one value, so that every client generator understands them.

mod campaign;
mod comparison;
mod dataset;
mod event;
mod job;
mod key;
mod problem;
mod problem_help;
mod report;
mod session;
mod tracking_events;
mod usage;

pub use campaign::*;
pub use comparison::*;
pub use dataset::*;
pub use event::*;
pub use job::*;
pub use key::*;
pub use problem::*;
pub use problem_help::explanation;
pub use report::*;
pub use session::*;
pub use tracking_events::*;
pub use usage::*;
