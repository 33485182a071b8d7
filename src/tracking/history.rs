//! The recorder of a job: one entry a track and scan, in scan order, turned into tracks at the end.

use super::recorder::{RecordedPoint, Recorder};
use super::smoothing::{self, PackedBeliefs, Smoothed, Smoothing};
use crate::filtering::AnyFilter;
use crate::hypotheses::bounds;
use crate::model::attributes::Attributes;
use crate::model::changes::Changes;
use crate::model::modes::ModeTable;
use crate::model::scan::{Recording, Scan};
use crate::model::space::Space;
use crate::model::track::{Candidate, Kinematics, Track, TrackPoint, TrackSet, TrackStatus};
use crate::model::watch::Halt;

/// A track at one scan.
#[derive(Debug, Clone, Copy)]
struct Entry {
    serial: u32,
    /// Index of the scan in the recording.
    scan: u32,
    status: TrackStatus,
    /// How many of the history's candidates are its; they follow those of the entry before.
    candidates: u32,
    /// NaN where there is none.
    nis: f64,
    known_at_s: f64,
    /// NaN where there is none.
    existence: f64,
}

/// Entries of a piece of a long history: some megabytes.
const LARGEST_PIECE: usize = 1 << 15;
const SMALLEST_PIECE: usize = 1 << 8;

/// Entries, and the packed kinematics of each one after the other.
#[derive(Debug)]
struct Piece {
    entries: Vec<Entry>,
    kinematics: Vec<f64>,
    /// Probabilities of the motion models, as many for each entry.
    modes: Vec<f64>,
    /// Packed beliefs, as many numbers for each entry; empty where nobody smooths.
    beliefs: Vec<f64>,
}

/// Everything a tracker did.
#[derive(Debug, Default)]
pub struct History {
    /// In pieces that are never moved: what a scene of many targets remembers is too long to be copied as it grows.
    pieces: Vec<Piece>,
    candidates: Vec<Candidate>,
    /// Candidates beyond the first of each entry.
    surplus: usize,
    /// Whether each track was ever confirmed, by serial.
    confirmed: Vec<bool>,
    /// Names of the tracks that were given at the start; theirs are the first serials.
    names: Vec<String>,
    /// Serials of a track that ended and of the one that went on, and when.
    merged: Vec<(u32, u32, f64)>,
}

/// A track that ended because another one followed the same target.
#[derive(Debug, Clone, PartialEq)]
pub struct Merge {
    pub track_id: String,
    pub into_track_id: String,
    pub time_s: f64,
}

impl Recorder for History {
    fn given(&mut self, serial: u32, name: &str) {
        self.note(serial, true);
        self.names.push(name.to_owned());
    }

    fn point(&mut self, point: &RecordedPoint) {
        self.note(point.serial, point.status != TrackStatus::Tentative);
        self.surplus += point.candidates.len().saturating_sub(1);
        self.candidates.extend_from_slice(point.candidates);
        let has_room = |piece: &Piece| piece.entries.len() < piece.entries.capacity();
        if !self.pieces.last().is_some_and(has_room) {
            self.start_piece(point);
        }
        if let Some(piece) = self.pieces.last_mut() {
            piece.kinematics.extend_from_slice(point.kinematics);
            piece.modes.extend_from_slice(point.modes);
            piece.beliefs.extend_from_slice(point.belief);
            piece.entries.push(Entry {
                serial: point.serial,
                scan: point.scan_index,
                status: point.status,
                candidates: point.candidates.len() as u32,
                nis: point.nis.unwrap_or(f64::NAN),
                known_at_s: point.known_at_s,
                existence: point.existence.unwrap_or(f64::NAN),
            });
        }
    }

    fn check(&self, scan: &Scan) -> Result<(), Halt> {
        bounds::check_history(self.surplus, scan)
    }

    fn end(&mut self, _serial: u32) {}

    fn merged(&mut self, serial: u32, into: u32, time_s: f64) {
        self.merged.push((serial, into, time_s));
    }
}

impl History {
    fn note(&mut self, serial: u32, is_confirmed: bool) {
        let serial = serial as usize;
        if self.confirmed.len() <= serial {
            self.confirmed.resize(serial + 1, false);
        }
        self.confirmed[serial] |= is_confirmed;
    }

    /// Each piece is as long as all before it together, up to a limit.
    #[cold]
    fn start_piece(&mut self, first: &RecordedPoint) {
        let before: usize = self.pieces.iter().map(|piece| piece.entries.len()).sum();
        let length = before.clamp(SMALLEST_PIECE, LARGEST_PIECE);
        self.pieces.push(Piece {
            entries: Vec::with_capacity(length),
            kinematics: Vec::with_capacity(length * first.kinematics.len()),
            modes: Vec::with_capacity(length * first.modes.len()),
            beliefs: Vec::with_capacity(length * first.belief.len()),
        });
    }

    /// Of each track that was ever confirmed what was believed at its points, in their order. Nothing where beliefs were not kept.
    fn beliefs(&self, recording: &Recording) -> Vec<PackedBeliefs<'_>> {
        let mut place_of = vec![usize::MAX; self.confirmed.len()];
        let mut tracks: Vec<PackedBeliefs> = Vec::new();
        for (serial, _) in self.confirmed.iter().enumerate().filter(|(_, is)| **is) {
            place_of[serial] = tracks.len();
            tracks.push(PackedBeliefs::default());
        }
        for piece in &self.pieces {
            let values = piece.beliefs.len() / piece.entries.len();
            let beliefs = piece.beliefs.chunks(values.max(1));
            for (entry, belief) in piece.entries.iter().zip(beliefs) {
                if let Some(track) = tracks.get_mut(place_of[entry.serial as usize]) {
                    track
                        .times_s
                        .push(recording.scans[entry.scan as usize].time_s);
                    track.beliefs.push(belief);
                }
            }
        }
        tracks
    }

    /// The tracks, and the same in the light of later scans where the tracker was told to keep what that takes.
    pub fn into_smoothed(
        self,
        recording: &Recording,
        filter: &AnyFilter,
        smoothing: Option<Smoothing>,
    ) -> (TrackSet, Option<TrackSet>) {
        let smooth = |smoothing| smoothing::smooth(filter, smoothing, &self.beliefs(recording));
        let smoothed = smoothing.map(smooth);
        let tracks = self.into_tracks(recording);
        let smoothed = smoothed.map(|smoothed| replaced(&tracks, smoothed));
        (tracks, smoothed)
    }

    /// The tracks that ended because another one followed the same target, in order of time.
    pub fn merges(&self) -> Vec<Merge> {
        let merge = |&(serial, into, time_s): &(u32, u32, f64)| Merge {
            track_id: self.name_of(serial),
            into_track_id: self.name_of(into),
            time_s,
        };
        self.merged.iter().map(merge).collect()
    }

    /// As [`History::into_tracks`] names a track that was confirmed.
    fn name_of(&self, serial: u32) -> String {
        let before = self.confirmed[..serial as usize].iter().filter(|is| **is);
        let named = self.names.get(serial as usize).cloned();
        named.unwrap_or_else(|| (before.count() + 1).to_string())
    }

    /// The tracks that were ever confirmed, from their first detection on, named 1, 2, … in order of initiation; those that
    /// were given keep their names.
    pub fn into_tracks(mut self, recording: &Recording) -> TrackSet {
        let mut lengths = vec![0; self.confirmed.len()];
        for entry in self.pieces.iter().flat_map(|piece| &piece.entries) {
            lengths[entry.serial as usize] += 1;
        }
        let mut number_of = vec![u32::MAX; self.confirmed.len()];
        let mut tracks: Vec<Track> = Vec::new();
        for (serial, _) in self.confirmed.iter().enumerate().filter(|(_, is)| **is) {
            number_of[serial] = tracks.len() as u32;
            let named = self.names.get(serial).cloned();
            tracks.push(Track {
                track_id: named.unwrap_or_else(|| (tracks.len() + 1).to_string()),
                points: Vec::with_capacity(lengths[serial]),
            });
        }
        let firsts = recording.scans_with_firsts().map(|(first, _)| first as u32);
        let firsts: Vec<u32> = firsts.collect();
        let mut first_candidate = 0;
        let (mut space, mut table) = (Space::default(), ModeTable::default());
        // Each piece goes when it is read: the history of a large scene and its tracks need not be there together.
        for piece in self.pieces {
            let values = piece.kinematics.len() / piece.entries.len();
            let of_piece = Space::of_packed(values);
            let modes = piece.modes.len() / piece.entries.len();
            let values = piece.entries.iter().zip(piece.kinematics.chunks(values));
            for (index, (entry, kinematics)) in values.enumerate() {
                let candidates = first_candidate..first_candidate + entry.candidates as usize;
                let first = firsts[entry.scan as usize];
                for candidate in &mut self.candidates[candidates.clone()] {
                    candidate.detection = candidate.detection.map(|detection| first + detection);
                }
                if let Some(track) = tracks.get_mut(number_of[entry.serial as usize] as usize) {
                    space = of_piece;
                    let estimate = Kinematics::unpack(space, kinematics);
                    let point = point(entry, first_candidate, estimate, recording);
                    let mode_row = table.push(&piece.modes[index * modes..][..modes]);
                    track.points.push(TrackPoint { mode_row, ..point });
                }
                first_candidate = candidates.end;
            }
        }
        TrackSet {
            space,
            frame: recording.frame,
            time_base: recording.time_base,
            tracks,
            attributes: Attributes::new(),
            changes: Changes::default(),
            candidates: self.candidates,
            modes: table,
            detection_ids: recording.detection_ids.clone(),
            sensor_ids: recording
                .sensors
                .iter()
                .map(|sensor| sensor.sensor_id.clone())
                .collect(),
        }
    }
}

/// The same tracks with other estimates at their points.
fn replaced(tracks: &TrackSet, estimates: Vec<Smoothed>) -> TrackSet {
    let mut set = tracks.clone();
    set.modes = ModeTable::default();
    for (track, estimates) in set.tracks.iter_mut().zip(estimates) {
        let points = track.points.len().max(1);
        let modes = estimates.modes.len() / points;
        let values = estimates.kinematics.len() / points;
        let kinematics = estimates.kinematics.chunks(values.max(1));
        for (index, (point, kinematics)) in track.points.iter_mut().zip(kinematics).enumerate() {
            point.estimate = Kinematics::unpack(set.space, kinematics);
            point.mode_row = set.modes.push(&estimates.modes[index * modes..][..modes]);
        }
    }
    set
}

fn point(
    entry: &Entry,
    first_candidate: usize,
    estimate: Kinematics,
    recording: &Recording,
) -> TrackPoint {
    let scan = &recording.scans[entry.scan as usize];
    TrackPoint {
        height_m: None,
        time_s: scan.time_s,
        sensor: Some(scan.sensor as u32),
        estimate,
        status: Some(entry.status),
        nis: Some(entry.nis).filter(|nis| !nis.is_nan()),
        known_at_s: (entry.known_at_s > scan.time_s).then_some(entry.known_at_s),
        existence: Some(entry.existence).filter(|existence| !existence.is_nan()),
        mode_row: None,
        first_candidate: first_candidate as u32,
        candidates: entry.candidates,
    }
}
