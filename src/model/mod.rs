//! The nouns every other layer speaks: sensors, scans, detections, truth, tracks, scenarios.
//! Plain values whose constructors check; no algorithm, file, clock or random number lives here.

pub mod allowance;
pub mod bearing_time;
pub mod boxes;
pub mod dataset;
pub mod facts;
pub mod fault;
pub mod motion;
pub mod names;
pub mod scan;
pub mod scan_numbers;
pub mod scenario;
pub mod sensor;
pub mod space;
pub mod state;
pub mod track;
pub mod truth;
pub mod watch;
