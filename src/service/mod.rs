//! The only layer with a clock, files, threads, SQL and a network.
//!
//! - [`types`]: what goes over the wire, with its schema.
//! - [`config`]: what can be set.
//! - `storage`: one SQLite file and a directory of blobs; the truth about datasets and jobs.
//! - `engine`: the queue, which only says "look at this job now".
//! - [`jobs`]: submitting, running, waiting, cancelling; the facade that HTTP and the command line call.

pub mod cli;
pub mod config;
pub mod dashboard;
mod engine;
pub mod error;
pub mod http;
pub mod jobs;
pub mod openapi;
pub mod server;
mod storage;
pub mod types;
pub mod views;
