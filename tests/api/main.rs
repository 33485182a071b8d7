//! The API through its front door: a real server on a free port with a directory of its own, asked over HTTP.
//! One module for what a user does, mirroring the routes.
mod bad_files;
mod bad_requests;
mod bearing_time;
mod campaigns;
mod catalogue;
mod comparison;
mod connections;
mod correlations;
mod datasets;
mod doors;
mod evaluations;
mod events;
mod helpers;
mod job_shape;
mod jobs;
mod keys;
mod life;
mod limits;
mod problems;
mod raw_uploads;
mod results;
mod sessions;
mod shutdown;
mod told_at_once;
mod transport;
mod written_formats;
