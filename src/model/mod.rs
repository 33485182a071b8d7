//! The nouns every other layer speaks: sensors, scans, detections, truth, tracks, scenarios; how targets move ([`motion`]) and
//! what sensors report of them ([`sensing`]).
//! Plain values whose constructors check; no algorithm, file, clock or random number lives here.

pub mod allowance;
pub mod angle;
pub mod attributes;
pub mod bearing_time;
pub mod beside;
pub mod boxes;
pub mod changes;
pub mod dataset;
pub mod facts;
pub mod fault;
pub mod modes;
pub mod motion;
pub mod names;
pub mod own;
pub mod pose;
pub mod relative_bearings;
pub mod scan;
pub mod scan_numbers;
pub mod scenario;
pub mod sensing;
pub mod sensor;
pub mod sight;
pub mod space;
pub mod state;
pub mod time;
pub mod track;
pub mod truth;
pub mod units;
pub mod watch;
