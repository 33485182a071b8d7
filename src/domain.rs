//! The domain of trackloom: data association, track correlation and track evaluation, without clock, file, thread or network.
//!
//! Layers, each using only those above it in this list:
//!
//! - [`model`], [`math`], [`registry`], [`geodesy`]: words and tools.
//! - [`simulation`], [`detection`], [`filtering`], [`gating`], [`association`], [`correlation`], [`evaluation`], [`formats`]: the
//!   steps; siblings do not know each other.
//! - [`hypotheses`]: gates and likelihoods of tracks and detections, from filters and gates.
//! - [`tracking`]: trackers, composed of steps. [`experiment`]: whole jobs, pure.

#![forbid(unsafe_code)]

pub mod association;
pub mod correlation;
pub mod detection;
pub mod evaluation;
pub mod experiment;
pub mod filtering;
pub mod formats;
pub mod gating;
pub mod geodesy;
pub mod hypotheses;
pub mod math;
pub mod model;
pub mod registry;
pub mod simulation;
pub mod tracking;
