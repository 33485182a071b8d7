//! trackloom: data association, track correlation and track evaluation as a web service.
//!
//! The domain is a package of its own, `trackloom-domain`, which knows no service. Here stands the [`service`]: HTTP, SQL, the
//! queue, the command line; the only place with a clock, files and threads.

#![forbid(unsafe_code)]

pub use trackloom_domain::{
    evaluation, experiment, formats, math, model, registry, simulation, tracking,
};

pub mod service;
