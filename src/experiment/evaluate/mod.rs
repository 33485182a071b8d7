//! Judges tracks: by metrics, and by the temporal automaton.

pub mod automaton;
mod metric_files;
pub mod metrics;
pub mod profiles;
mod progress;
