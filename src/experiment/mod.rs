//! Whole jobs, still pure: from a checked request and loaded datasets to a result, its artefacts and its warnings.
//!
//! `plan` checks a request and says which inputs it needs; the caller loads them; `run` does the work.
//! No clock, file, thread or network: time is measured and bytes are stored by whoever calls.

mod apparent_speed;
mod artifacts;
mod associate;
mod auto_filter;
pub mod campaign;
pub mod catalogue;
mod checks;
mod clutter;
mod correlate;
mod detect;
mod extent;
pub mod gates;
mod given;
mod group;
mod group_report;
pub mod job_shape;
mod judge;
pub mod known_data;
mod metric_files;
mod no_tracks;
mod noise;
pub mod observer;
pub mod plan;
mod preset_source;
pub mod presets;
mod profiles;
mod record_picture;
mod rehearsal;
mod requests;
pub mod run;
mod scan_gaps;
mod scenario_tables;
mod scene;
mod sensors;
mod speeds;
mod tables;
pub mod text;
mod tfa;
mod told;
