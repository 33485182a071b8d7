//! What a tracker did: one entry a track and scan, in scan order, turned into tracks at the end.

use crate::model::scan::Recording;
use crate::model::space::Space;
use crate::model::state::{GaussianState, packed_len};
use crate::model::track::{Candidate, Kinematics, Track, TrackPoint, TrackSet, TrackStatus};

/// A track at one scan.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    /// Number of the track in order of initiation, tentative ones counted too.
    pub serial: u32,
    /// Index of the scan in the recording.
    pub scan: u32,
    pub status: TrackStatus,
    /// How many of the history's candidates are its; they follow those of the entry before.
    pub candidates: u32,
    /// NaN where there is none.
    pub nis: f64,
}

/// Entries of a piece of a long history: some megabytes.
const LARGEST_PIECE: usize = 1 << 15;
const SMALLEST_PIECE: usize = 1 << 8;

/// Entries, and the packed state of each one after the other.
#[derive(Debug)]
struct Piece {
    entries: Vec<Entry>,
    states: Vec<f64>,
}

/// Everything a tracker remembers.
#[derive(Debug)]
pub struct History {
    /// Of each state.
    variables: usize,
    /// In pieces that are never moved: what a scene of many targets remembers is too long to be copied as it grows.
    pieces: Vec<Piece>,
    pub(super) candidates: Vec<Candidate>,
    /// Candidates beyond the first of each entry.
    pub(super) surplus: usize,
    /// Tracks ever started; serials are below it.
    pub(super) started: u32,
    /// Serials of the tracks that were ever confirmed.
    pub(super) confirmed: Vec<u32>,
    /// Names of the tracks that were given at the start; theirs are the first serials.
    pub(super) names: Vec<String>,
}

impl History {
    pub(super) fn new(variables: usize) -> Self {
        History {
            variables,
            pieces: Vec::new(),
            candidates: Vec::new(),
            surplus: 0,
            started: 0,
            confirmed: Vec::new(),
            names: Vec::new(),
        }
    }

    pub(super) fn push<const N: usize>(&mut self, entry: Entry, state: &GaussianState<N>) {
        debug_assert_eq!(N, self.variables);
        self.surplus += entry.candidates.saturating_sub(1) as usize;
        let has_room = |piece: &Piece| piece.entries.len() < piece.entries.capacity();
        if !self.pieces.last().is_some_and(has_room) {
            self.start_piece();
        }
        if let Some(piece) = self.pieces.last_mut() {
            piece.entries.push(entry);
            state.pack_into(&mut piece.states);
        }
    }

    /// Each piece is as long as all before it together, up to a limit.
    #[cold]
    fn start_piece(&mut self) {
        let before: usize = self.pieces.iter().map(|piece| piece.entries.len()).sum();
        let length = before.clamp(SMALLEST_PIECE, LARGEST_PIECE);
        self.pieces.push(Piece {
            entries: Vec::with_capacity(length),
            states: Vec::with_capacity(length * packed_len(self.variables)),
        });
    }

    /// The tracks that were ever confirmed, from their first detection on, named 1, 2, … in order of initiation; those that
    /// were given keep their names.
    pub fn into_tracks(mut self, recording: &Recording) -> TrackSet {
        self.confirmed.sort_unstable();
        let mut lengths = vec![0; self.started as usize];
        for entry in self.pieces.iter().flat_map(|piece| &piece.entries) {
            lengths[entry.serial as usize] += 1;
        }
        let mut number_of = vec![u32::MAX; self.started as usize];
        let mut tracks: Vec<Track> = Vec::with_capacity(self.confirmed.len());
        for (index, &serial) in self.confirmed.iter().enumerate() {
            number_of[serial as usize] = index as u32;
            let track_id = self
                .names
                .get(serial as usize)
                .cloned()
                .unwrap_or_else(|| (index + 1).to_string());
            tracks.push(Track {
                track_id,
                points: Vec::with_capacity(lengths[serial as usize]),
            });
        }
        let mut first_candidate = 0;
        // Each piece goes when it is read: the history of a large scene and its tracks need not be there together.
        let space = Space::of_state(self.variables);
        for Piece { entries, states } in self.pieces {
            let states = states.chunks_exact(packed_len(self.variables));
            for (entry, state) in entries.iter().zip(states) {
                if let Some(track) = tracks.get_mut(number_of[entry.serial as usize] as usize) {
                    let estimate = Kinematics::unpack(space, state);
                    track
                        .points
                        .push(point(entry, first_candidate, estimate, recording));
                }
                first_candidate += entry.candidates as usize;
            }
        }
        TrackSet {
            space: space.of_points(!tracks.is_empty()),
            frame: recording.frame,
            tracks,
            candidates: self.candidates,
            detection_ids: recording.detection_ids.clone(),
            sensor_ids: recording
                .sensors
                .iter()
                .map(|sensor| sensor.sensor_id.clone())
                .collect(),
        }
    }
}

fn point(
    entry: &Entry,
    first_candidate: usize,
    estimate: Kinematics,
    recording: &Recording,
) -> TrackPoint {
    let scan = &recording.scans[entry.scan as usize];
    TrackPoint {
        time_s: scan.time_s,
        sensor: Some(scan.sensor as u32),
        estimate,
        status: Some(entry.status),
        nis: Some(entry.nis).filter(|nis| !nis.is_nan()),
        first_candidate,
        candidates: entry.candidates as usize,
    }
}
