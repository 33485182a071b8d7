//! What a tracker did: one entry a track and scan, in scan order, turned into tracks at the end.

use crate::model::scan::Recording;
use crate::model::state::PackedState;
use crate::model::track::{Candidate, Estimate, Track, TrackPoint, TrackSet, TrackStatus};

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
    pub state: PackedState,
    /// NaN where there is none.
    pub nis: f64,
}

/// Entries of a piece of a long history: some megabytes.
const LARGEST_PIECE: usize = 1 << 15;
const SMALLEST_PIECE: usize = 1 << 8;

/// Everything a tracker remembers.
#[derive(Debug)]
pub struct History {
    /// What a kept state says; it knows of how many variables.
    unpack: fn(&PackedState) -> Estimate,
    /// In pieces that are never moved: what a scene of many targets remembers is too long to be copied as it grows.
    pieces: Vec<Vec<Entry>>,
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
    pub(super) fn new(unpack: fn(&PackedState) -> Estimate) -> Self {
        History {
            unpack,
            pieces: Vec::new(),
            candidates: Vec::new(),
            surplus: 0,
            started: 0,
            confirmed: Vec::new(),
            names: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, entry: Entry) {
        self.surplus += entry.candidates.saturating_sub(1) as usize;
        match self
            .pieces
            .last_mut()
            .filter(|piece| piece.len() < piece.capacity())
        {
            Some(piece) => piece.push(entry),
            None => self.start_piece(entry),
        }
    }

    /// Each piece is as long as all before it together, up to a limit.
    #[cold]
    fn start_piece(&mut self, entry: Entry) {
        let length: usize = self.pieces.iter().map(Vec::len).sum();
        let mut piece = Vec::with_capacity(length.clamp(SMALLEST_PIECE, LARGEST_PIECE));
        piece.push(entry);
        self.pieces.push(piece);
    }

    /// The tracks that were ever confirmed, from their first detection on, named 1, 2, … in order of initiation; those that
    /// were given keep their names.
    pub fn into_tracks(mut self, recording: &Recording) -> TrackSet {
        self.confirmed.sort_unstable();
        let mut lengths = vec![0; self.started as usize];
        self.pieces
            .iter()
            .flatten()
            .for_each(|entry| lengths[entry.serial as usize] += 1);
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
        for entry in self.pieces.into_iter().flatten() {
            if let Some(track) = tracks.get_mut(number_of[entry.serial as usize] as usize) {
                track.points.push(point(
                    &entry,
                    first_candidate,
                    (self.unpack)(&entry.state),
                    recording,
                ));
            }
            first_candidate += entry.candidates as usize;
        }
        TrackSet {
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
    estimate: Estimate,
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
