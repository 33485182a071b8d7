//! The tests of the domain: one program, so that it is linked once.

#[path = "../../benches/support/coalescence.rs"]
mod coalescence_scene;
#[path = "../../benches/support/flights.rs"]
mod flights;
#[path = "../../benches/support/maneuver.rs"]
mod maneuver_scene;
#[path = "../../benches/support/random_tracks.rs"]
mod random_tracks;

mod associators;
mod asterix;
mod bad_association_input;
mod bearing_time;
mod bearings;
mod bounds;
mod cai_claims;
#[cfg(feature = "parquet")]
mod campaign_parquet;
mod campaigns;
mod causes;
mod coalescence;
mod correlate_jobs;
mod correlators;
mod defaults;
mod detectability;
mod determinism;
mod distances;
mod estimates;
mod evaluation_jobs;
mod feeds;
mod filters;
mod formations;
mod formats;
mod fuzz;
mod gates;
mod goldens;
mod grouping;
mod huo2008;
mod imm;
mod integer_programme;
mod liang_verdicts;
mod lifecycle;
mod maneuver;
mod meeting;
mod mixed;
mod motions;
mod moving_sensor;
mod multi_scan;
mod mutations;
mod oracle;
mod origins;
mod own;
mod own_ship;
mod polar;
mod real_files;
mod recorded_targets;
mod recordings;
mod recordings_undescribed;
mod requests_again;
mod right_values;
mod scenario_sensors;
mod segmentation;
mod session_picture;
mod session_reports;
mod sessions;
mod shared_gates;
mod smoothing;
mod sonar;
mod space;
mod tfa_by_hand;
mod track_alignment;
mod track_fusion;
mod track_statistics;
mod twins;
mod two_sensors;
mod undetected;
mod vision;
mod volumes;
mod wang_claims;
