//! Requests: the tables that describe them, what no table can check, and what is filled in.

pub mod checks;
pub mod fields;
pub mod job_shape;
pub mod preset_source;
pub mod scenario;
