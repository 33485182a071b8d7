//! Requests: the tables that describe them, what no table can check, and what is filled in. Only here a request is JSON; what
//! leaves is typed.

pub mod draft;
pub mod fields;
pub mod job_shape;
pub mod limits;
pub mod methods;
pub mod names;
pub mod paths;
pub mod preset_source;
pub mod scenario;
mod sight;
pub mod sources;
mod targets;
