//! The only layer with a clock, files, threads, SQL and a network.
//!
//! - [`types`]: what goes over the wire, with its schema.
//! - [`config`]: what can be set.
//! - `connections`: who may connect, and for how long the service waits for them.
//! - `storage`: one SQLite file and a directory of blobs; the truth about datasets and jobs.
//! - `child`: work in processes of their own, which may fail without the service.
//! - [`datasets`]: keeping files that hold datasets.
//! - `engine`: the queue, which only says "look at this job now".
//! - [`sessions`]: trackers of live feeds, each with a log in the tables.
//! - [`keys`]: who may do what.
//! - [`jobs`]: submitting, running, waiting, cancelling; the facade that HTTP and the command line call.

pub mod build_info;
mod canonical;
mod child;
pub mod cli;
pub mod config;
mod connections;
pub mod datasets;
mod engine;
pub mod error;
pub mod http;
pub mod jobs;
pub mod keys;
pub mod monitoring;
pub mod openapi;
mod panics;
mod rate;
pub mod server;
pub mod sessions;
mod storage;
pub mod types;
pub mod views;
