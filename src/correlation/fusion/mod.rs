//! From the tracks of a tuple to one system track: at each common time, one state of the states of its members. One file a
//! method, one line of [`FUSIONS`].

mod best_sensor;
mod covariance_intersection;
mod modified;
mod weighted;

use super::estimates::AlignedEstimate;
use super::evidence::Evidence;
use crate::model::state::{Covariance, GaussianState};
use crate::model::track::{Kinematics, Track, TrackPoint, TrackSet};
use crate::registry::{Method, Union};

/// What the members of a tuple say at one time.
pub struct Members<'a> {
    /// One or more.
    pub estimates: &'a [&'a AlignedEstimate],
    /// P_ij of members i < j, by (0, 1), (0, 2), …, (1, 2), …; empty where errors are taken to be independent.
    pub cross: &'a [Covariance],
}

/// Makes one state of several.
pub trait Fusion {
    /// `None` where their covariances cannot be put together.
    fn fuse(&self, members: &Members) -> Option<GaussianState>;
}

/// Builds a fusion from its checked parameters.
pub type BuildFusion = fn(&serde_json::Value) -> Result<Box<dyn Fusion>, serde_json::Error>;

/// Every fusion.
pub const FUSIONS: &[Method<BuildFusion>] = &[
    weighted::METHOD,
    covariance_intersection::METHOD,
    best_sensor::METHOD,
    modified::METHOD,
];

pub static FUSION: Union = Union {
    name: "Fusion",
    summary: "How the tracks of a tuple become one system track.",
    tag: "method",
    variants: || FUSIONS.iter().map(Method::variant).collect(),
};

/// A system track for each tuple, named by its place from 1, at the times at which a member says something.
pub fn system_tracks(evidence: &Evidence, tuples: &[Vec<u32>], fusion: &dyn Fusion) -> TrackSet {
    let track = |(index, tuple): (usize, &Vec<u32>)| Track {
        track_id: (index + 1).to_string(),
        points: (0..evidence.estimates.times())
            .filter_map(|time| point(evidence, tuple, time, fusion))
            .collect(),
    };
    let tracks = tuples
        .iter()
        .enumerate()
        .map(track)
        .filter(|track| !track.points.is_empty())
        .collect();
    TrackSet {
        tracks,
        ..TrackSet::default()
    }
}

fn point(
    evidence: &Evidence,
    tuple: &[u32],
    time: usize,
    fusion: &dyn Fusion,
) -> Option<TrackPoint> {
    let (present, estimates): (Vec<u32>, Vec<&AlignedEstimate>) = tuple
        .iter()
        .filter_map(|&track| Some((track, evidence.estimates.at(track, time)?)))
        .unzip();
    let pairs = || {
        (0..present.len())
            .flat_map(|left| (left + 1..present.len()).map(move |right| (left, right)))
    };
    let cross: Vec<Covariance> = evidence
        .cross
        .iter()
        .flat_map(|table| {
            pairs().map(|(left, right)| table.at(present[left], present[right], time))
        })
        .collect();
    let state = match estimates.as_slice() {
        [] => return None,
        [alone] => GaussianState {
            mean: alone.mean,
            covariance: alone.covariance,
        },
        several => fusion.fuse(&Members {
            estimates: several,
            cross: &cross,
        })?,
    };
    let has_velocity = evidence.estimates.has_velocity;
    let time_s = evidence.estimates.times_s[time];
    Some(TrackPoint {
        height_m: None,
        time_s,
        sensor: None,
        estimate: Kinematics::of_plane(&state.mean, has_velocity, Some(&state.covariance)),
        status: None,
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    })
}
