//! Tracks: rows of any interleaving of tracks; each track's times rise. Rows of one track, time and sensor are the
//! candidates of one point: a detection, or none (empty), with its probability. A row that repeats another one is taken once, and
//! told.

mod write;

pub use write::write;

use super::codes::Codes;
use super::estimate::EstimateColumns;
use super::ground::{self, Ground};
use super::header::{Header, MODE_COLUMNS};
use super::interner::Interner;
use super::row::RowReader;
use super::{Repeats, Table};
use crate::formats::Units;
use crate::formats::disorder::Disorder;
use crate::geodesy::Stereographic;
use crate::model::attributes::Attributes;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::modes::ModeTable;
use crate::model::track::{Candidate, Track, TrackPoint, TrackSet, TrackStatus};
use std::collections::{BTreeSet, HashMap};

/// Where the columns of tracks are.
struct Columns {
    time: usize,
    track: usize,
    estimate: EstimateColumns,
    sensor: Option<usize>,
    detection: Option<usize>,
    probability: Option<usize>,
    status: Option<usize>,
    nis: Option<usize>,
    known: Option<usize>,
    existence: Option<usize>,
    /// As many as there are without a gap.
    modes: Vec<usize>,
    attributes: Vec<(&'static str, usize)>,
}

impl Columns {
    fn from_header(header: &Header) -> Self {
        Columns {
            time: header.required("time_s"),
            track: header.required("track_id"),
            estimate: EstimateColumns::from_header(header),
            sensor: header.find("sensor_id"),
            detection: header.find("detection_id"),
            probability: header.find("probability"),
            status: header.find("status"),
            nis: header.find("nis"),
            known: header.find("known_at_s"),
            existence: header.find("existence"),
            modes: MODE_COLUMNS
                .iter()
                .map_while(|name| header.find(name))
                .collect(),
            attributes: header.attributes(),
        }
    }
}

/// One row that names a candidate, and the point it belongs to.
struct CandidateRow {
    track: u32,
    point: u32,
    row: u64,
    candidate: Candidate,
}

#[derive(Default)]
struct Builder {
    tracks: Interner,
    sensors: Interner,
    detections: Interner,
    /// Each track's points, and the row that each comes from.
    points: Vec<Vec<(TrackPoint, u64)>>,
    /// The point of each track, sensor and time; only looked up, never walked.
    latest: HashMap<(u32, Option<u32>, u64), usize>,
    /// Where each track goes in the natural order of names, once that is known.
    track_places: Vec<u32>,
    candidates: Vec<CandidateRow>,
    modes: ModeTable,
    repeats: Repeats,
    ground: Ground,
    disorder: Disorder,
    attributes: Attributes,
    codes: Codes,
}

/// Reads tracks, and tells how the rows fared.
///
/// # Errors
/// Every fault of the rows.
pub fn read(
    table: Table,
    header: &Header,
    warnings: &mut Vec<String>,
) -> Result<(Dataset, Units), Vec<Fault>> {
    let columns = Columns::from_header(header);
    let mut reader = RowReader::new(table.rows, header, table.reading);
    let mut builder = Builder::default();
    while reader.advance() {
        builder.read_row(&mut reader, &columns);
    }
    builder.check_candidates(&mut reader, &columns);
    builder.sort_points();
    warnings.extend(reader.told());
    warnings.extend(builder.disorder.warning(reader.row_word()));
    warnings.extend(reader.repeats_warning(&builder.repeats));
    let base = reader.time_base();
    let units = reader.finish(builder.repeats.count() as u64)?;
    let frame = builder.ground.frame(table.reading)?;
    if let (true, Some(plane)) = (
        columns.estimate.is_geographic(),
        frame.map(Stereographic::from),
    ) {
        builder.settle(&plane);
    }
    let mut set = builder.finish(&columns);
    (set.frame, set.time_base) = (frame, base);
    Ok((Dataset::Tracks(set), units))
}

impl Builder {
    fn read_row(&mut self, reader: &mut RowReader, columns: &Columns) {
        reader.require_name(columns.track);
        for column in [columns.sensor, columns.detection].into_iter().flatten() {
            reader.check_name(column);
        }
        let point = read_point(reader, columns);
        let modes = read_modes(reader, columns);
        let probability = read_probability(reader, columns);
        if reader.text(columns.track).is_empty() || reader.is_rejected() {
            return;
        }
        let track = self.tracks.number(reader.text(columns.track));
        let sensor = reader.optional_text(columns.sensor);
        let sensor = (!sensor.is_empty()).then(|| self.sensors.number(sensor));
        let Some(point) = point else { return };
        columns
            .estimate
            .note_earth(&point.estimate.position, reader, &mut self.ground);
        reader.note_attributes(columns.track, &columns.attributes, &mut self.attributes);
        self.codes
            .note(reader, &columns.attributes, (track, point.time_s));
        let point = TrackPoint { sensor, ..point };
        let point = self.place(reader, columns, track, point, &modes);
        if reader.is_rejected() {
            return;
        }
        let detection = reader.optional_text(columns.detection);
        if let Some(probability) = probability
            && columns.detection.is_some()
        {
            let detection = (!detection.is_empty()).then(|| self.detections.number(detection));
            let candidate = Candidate {
                detection,
                probability,
            };
            self.candidates.push(CandidateRow {
                track,
                point,
                row: reader.row(),
                candidate,
            });
        }
    }

    /// The point of a row within its track: one that is there already, or a new one at the end.
    fn place(
        &mut self,
        reader: &mut RowReader,
        columns: &Columns,
        track: u32,
        point: TrackPoint,
        modes: &[f64],
    ) -> u32 {
        if self.points.len() <= track as usize {
            self.points.resize_with(track as usize + 1, Vec::new);
        }
        let points = &mut self.points[track as usize];
        let key = (track, point.sensor, point.time_s.to_bits());
        let known = *self.latest.entry(key).or_insert(points.len());
        if let Some((known_point, row)) = points.get(known) {
            let mode_row = known_point.mode_row;
            let said_again = TrackPoint { mode_row, ..point };
            if columns.detection.is_none() && *known_point == said_again {
                self.repeats.add(reader.row());
            } else {
                check_same_point(reader, columns, known_point, &said_again, *row);
            }
            return known as u32;
        }
        let mut latest_s = points
            .last()
            .map_or(f64::NEG_INFINITY, |(last, _)| last.time_s);
        self.disorder
            .note(&mut latest_s, point.time_s, reader.row());
        let mode_row = self.modes.push(modes);
        points.push((TrackPoint { mode_row, ..point }, reader.row()));
        known as u32
    }

    /// Brings each track's points into the order of time, and with them the candidates, which are in the order of points.
    fn sort_points(&mut self) {
        for (track, points) in self.points.iter_mut().enumerate() {
            if points.is_sorted_by(|a, b| a.0.time_s <= b.0.time_s) {
                continue;
            }
            let mut order: Vec<usize> = (0..points.len()).collect();
            order.sort_by(|&a, &b| points[a].0.time_s.total_cmp(&points[b].0.time_s));
            let mut place = vec![0; order.len()];
            for (new, &old) in order.iter().enumerate() {
                place[old] = new as u32;
            }
            *points = order.iter().map(|&old| points[old].clone()).collect();
            let of_track = self
                .track_places
                .get(track)
                .copied()
                .unwrap_or(track as u32);
            for row in self
                .candidates
                .iter_mut()
                .filter(|row| row.track == of_track)
            {
                row.point = place[row.point as usize];
            }
        }
        self.candidates.sort_by_key(|row| (row.track, row.point));
    }

    fn settle(&mut self, plane: &Stereographic) {
        for (point, _) in self.points.iter_mut().flatten() {
            let estimate = &mut point.estimate;
            ground::settle(plane, &mut estimate.position, estimate.velocity.as_mut());
        }
    }

    /// Brings candidates into the order of tracks and points, and finds detections named twice for one point: with the same
    /// probability one of the two is dropped.
    fn check_candidates(&mut self, reader: &mut RowReader, columns: &Columns) {
        let Some(column) = columns.detection else {
            return;
        };
        let places = self.tracks.places();
        self.track_places.clone_from(&places);
        self.candidates
            .iter_mut()
            .for_each(|candidate| candidate.track = places[candidate.track as usize]);
        self.candidates
            .sort_by_key(|candidate| (candidate.track, candidate.point));
        let mut named: Vec<(Option<u32>, u64, f64)> = Vec::new();
        let mut repeated = BTreeSet::new();
        for group in self
            .candidates
            .chunk_by(|a, b| (a.track, a.point) == (b.track, b.point))
        {
            named.clear();
            named.extend(
                group
                    .iter()
                    .map(|row| (row.candidate.detection, row.row, row.candidate.probability)),
            );
            named.sort_unstable_by_key(|&(detection, row, _)| (detection, row));
            for pair in named.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                if pair[0].2 == pair[1].2 {
                    repeated.insert(pair[1].1);
                    self.repeats.add(pair[1].1);
                    continue;
                }
                let what = pair[1].0.map_or("'no detection'".to_owned(), |number| {
                    format!("detection '{}'", self.detections.name(number))
                });
                let detail = format!(
                    "{what} occurs twice for one track and time: also on {}",
                    reader.called(pair[0].1)
                );
                reader.fault_in(pair[1].1, column, "duplicate", detail);
            }
        }
        if !repeated.is_empty() {
            self.candidates
                .retain(|candidate| !repeated.contains(&candidate.row));
        }
    }

    /// Tracks and sensors in natural order; detections in the order that candidates name them.
    fn finish(self, columns: &Columns) -> TrackSet {
        let space = columns.estimate.space;
        let changes = self.codes.finish(&columns.attributes, &self.tracks);
        let (names, track_place) = self.tracks.sorted();
        let (sensor_ids, sensor_place) = self.sensors.sorted();
        let mut tracks: Vec<Track> = names
            .into_iter()
            .map(|track_id| Track {
                track_id,
                points: Vec::new(),
            })
            .collect();
        for (points, &place) in self.points.into_iter().zip(&track_place) {
            tracks[place as usize].points = points.into_iter().map(|(point, _)| point).collect();
        }
        let mut candidates = Vec::with_capacity(self.candidates.len());
        let mut rest = self.candidates.as_slice();
        for (track, points) in tracks
            .iter_mut()
            .enumerate()
            .map(|(index, track)| (index as u32, &mut track.points))
        {
            for (index, point) in points.iter_mut().enumerate() {
                let count = rest
                    .iter()
                    .take_while(|row| (row.track, row.point) == (track, index as u32))
                    .count();
                (point.first_candidate, point.candidates) = (candidates.len() as u32, count as u32);
                point.sensor = point.sensor.map(|sensor| sensor_place[sensor as usize]);
                candidates.extend(rest[..count].iter().map(|row| row.candidate));
                rest = &rest[count..];
            }
        }
        let detection_ids = renumber(&mut candidates, self.detections.into_names());
        TrackSet {
            space: space.of_points(!tracks.is_empty()),
            tracks,
            candidates,
            modes: self.modes,
            detection_ids,
            sensor_ids,
            attributes: self.attributes,
            changes,
            ..TrackSet::default()
        }
    }
}

/// Numbers detections in the order that candidates name them, whatever the order of the rows was; returns their names.
fn renumber(candidates: &mut [Candidate], mut names: Vec<String>) -> Vec<String> {
    let mut numbers: Vec<Option<u32>> = vec![None; names.len()];
    let mut ordered = Vec::with_capacity(names.len());
    for detection in candidates
        .iter_mut()
        .filter_map(|candidate| candidate.detection.as_mut())
    {
        let old = *detection as usize;
        *detection = *numbers[old].get_or_insert_with(|| {
            ordered.push(std::mem::take(&mut names[old]));
            ordered.len() as u32 - 1
        });
    }
    ordered
}

/// The row's point, without its sensor and candidates.
fn read_point(reader: &mut RowReader, columns: &Columns) -> Option<TrackPoint> {
    let time_s = reader.time(columns.time);
    let estimate = columns.estimate.read(reader);
    let height_m = columns.estimate.read_height(reader);
    let status = read_status(reader, columns);
    let nis = read_nis(reader, columns);
    Some(TrackPoint {
        time_s: time_s?,
        sensor: None,
        estimate: estimate?,
        height_m,
        status,
        nis,
        known_at_s: reader.optional_number(columns.known),
        existence: columns
            .existence
            .and_then(|column| read_existence(reader, column)),
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    })
}

fn read_nis(reader: &mut RowReader, columns: &Columns) -> Option<f64> {
    let (column, nis) = (columns.nis?, reader.optional_number(columns.nis)?);
    if nis < 0.0 {
        reader.fault_allowing(
            column,
            "out_of_range",
            format!("{nis} is not a square"),
            ">= 0",
        );
    }
    Some(nis)
}

fn read_existence(reader: &mut RowReader, column: usize) -> Option<f64> {
    let existence = reader.optional_number(Some(column))?;
    check_probability(reader, column, existence);
    Some(existence)
}

fn check_probability(reader: &mut RowReader, column: usize, value: f64) {
    if !(0.0..=1.0).contains(&value) {
        let detail = format!("{value} is not a probability");
        reader.fault_allowing(column, "out_of_range", detail, "0 to 1");
    }
}

/// The probabilities of the row's models; none where one is missing.
fn read_modes(reader: &mut RowReader, columns: &Columns) -> Vec<f64> {
    let mut modes = Vec::new();
    for &column in &columns.modes {
        let Some(probability) = reader.optional_number(Some(column)) else {
            return Vec::new();
        };
        check_probability(reader, column, probability);
        modes.push(probability);
    }
    modes
}

fn read_status(reader: &mut RowReader, columns: &Columns) -> Option<TrackStatus> {
    let column = columns.status?;
    let text = reader.text(column);
    let status = TrackStatus::ALL
        .into_iter()
        .find(|(_, name)| *name == text)
        .map(|(status, _)| status);
    if status.is_none() && !text.is_empty() {
        let detail = format!("'{text}' is not a status");
        reader.fault_allowing(
            column,
            "unknown_value",
            detail,
            &TrackStatus::ALL.map(|(_, name)| name).join(", "),
        );
    }
    status
}

/// The probability of the row's candidate: 1 where the file does not say; `None` where there is no candidate, which a
/// row says by leaving both the detection and the probability empty.
fn read_probability(reader: &mut RowReader, columns: &Columns) -> Option<f64> {
    let Some(column) = columns.probability else {
        return Some(1.0);
    };
    if reader.text(column).trim_ascii().is_empty() {
        return (!reader.optional_text(columns.detection).is_empty()).then_some(1.0);
    }
    let probability = reader.number(column)?;
    if !(0.0..=1.0).contains(&probability) {
        reader.fault_allowing(
            column,
            "out_of_range",
            format!("{probability} is not a probability"),
            "0 to 1",
        );
        return None;
    }
    Some(probability)
}

/// A second row of one track, time and sensor must be another candidate of the same point.
fn check_same_point(
    reader: &mut RowReader,
    columns: &Columns,
    known: &TrackPoint,
    point: &TrackPoint,
    row: u64,
) {
    let (name, time_s, before) = (reader.text(columns.track), point.time_s, reader.called(row));
    if columns.detection.is_none() {
        let detail = format!("track '{name}' is at {time_s} s twice: also on {before}");
        reader.fault(columns.time, "duplicate", detail);
    } else if known.estimate.position != point.estimate.position {
        let detail = format!("track '{name}' at {time_s} s is at another position on {before}");
        reader.fault(columns.estimate.first(), "conflict", detail);
    }
}
