//! MOTChallenge text: boxes of truth or of tracks, one a line without a header, separated by commas, or by spaces or tabs.
//!
//! `frame,id,left,top,width,height,confidence,…`: 6 to 10 values, the confidence 1 where it is left out. Frames count from
//! 1; edges are in pixels. What follows the confidence is not read, but for truth with exactly 9 values (MOT16 and later),
//! whose eighth is a class. As the benchmark has it, rows of truth with confidence 0 are left out, and so are classes other
//! than 1 (pedestrian). Tracks on distractors (classes 2, 7, 8 and 12) are forgiven, on other classes they are false.
//! Of detections the number of the object is not read.
//!
//! # Reference
//! A. Milan, L. Leal-Taixé, I. Reid, S. Roth, K. Schindler, MOT16: A Benchmark for Multi-Object Tracking, 2016.

use super::lines;
use super::table::{FaultLog, Repeats, push_number};
use super::{Format, ReadOptions, ReadOutcome, Reading, Units, mot_detections, refuse_columns};
use crate::model::boxes::{BoxSet, ObjectBox, OtherBox};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use std::collections::BTreeMap;
use std::io::{self, BufRead, Write};

pub const FORMAT: Format = Format {
    name: "mot",
    summary: "MOTChallenge text: boxes of truth, tracks or a detector in the frames of a video",
    media_type: "text/plain",
    kinds: &[
        DatasetKind::Truth,
        DatasetKind::Tracks,
        DatasetKind::Detections,
    ],
    options: &[],
    read,
};

const COLUMNS: [&str; 8] = [
    "frame",
    "id",
    "left",
    "top",
    "width",
    "height",
    "confidence",
    "class",
];
/// Values in a row of truth that has a class.
const WITH_CLASS: usize = 9;
const PEDESTRIAN: f64 = 1.0;
/// A person on a vehicle, one who does not move, what looks like one, a reflection.
const DISTRACTORS: [f64; 4] = [2.0, 7.0, 8.0, 12.0];
const KINDS: &str = "truth, tracks, detections";

/// Reads one file; the options must say whether it is truth, tracks or detections.
///
/// # Errors
/// Every fault, with line and column.
pub fn read(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    refuse_columns(options)?;
    let Some(kind) = options.kind else {
        let detail = "files in the format 'mot' do not say what they hold";
        return Err(vec![
            Fault::new("/meta/kind", "missing", detail).allowing(KINDS),
        ]);
    };
    if !FORMAT.kinds.contains(&kind) {
        let detail = format!("files in the format 'mot' cannot hold {}", kind.name());
        return Err(vec![
            Fault::new("/meta/kind", "unsupported", detail).allowing(KINDS),
        ]);
    }
    let mut reader = Reader {
        is_truth: kind == DatasetKind::Truth,
        is_of_detector: kind == DatasetKind::Detections,
        ..Reader::default()
    };
    reader.lines(input)?;
    if reader.is_of_detector {
        let reading = Reading::of(&options.options)?;
        return reader.finish_detections(reading.frame_s.unwrap_or(1.0));
    }
    reader.finish()
}

#[derive(Default)]
struct Reader {
    is_truth: bool,
    is_of_detector: bool,
    faults: FaultLog,
    /// Each with the number in the file in place of the object's index, and its line.
    boxes: Vec<(i64, ObjectBox, u64)>,
    without_confidence: u64,
    /// Of truth with classes: what is no pedestrian to be found.
    others: Vec<OtherBox>,
}

impl Reader {
    fn lines(&mut self, input: &mut dyn BufRead) -> Result<(), Vec<Fault>> {
        let mut bytes = Vec::new();
        for line in 1.. {
            let is_read =
                lines::read_line(input, &mut bytes).map_err(|error| match error.kind() {
                    io::ErrorKind::FileTooLarge => vec![lines::too_long(line)],
                    _ => vec![unreadable(
                        line,
                        format!("the file cannot be read further: {error}"),
                    )],
                })?;
            if !is_read || self.faults.is_full() {
                break;
            }
            let bytes = if line == 1 {
                bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes)
            } else {
                &bytes
            };
            match std::str::from_utf8(bytes) {
                Ok(text) if text.trim().is_empty() => {}
                Ok(text) => self.row(line, text.trim()),
                Err(_) => self
                    .faults
                    .push(unreadable(line, "the text is not UTF-8".to_owned())),
            }
        }
        Ok(())
    }

    fn row<'t>(&mut self, line: u64, text: &'t str) {
        let mut cells = [""; 10];
        let mut count = 0;
        let mut keep = |cell: &'t str| {
            if let Some(place) = cells.get_mut(count) {
                *place = cell.trim();
            }
            count += 1;
        };
        // Spaces after commas separate nothing.
        if text.contains(',') {
            text.split(',').for_each(&mut keep);
        } else {
            text.split_whitespace().for_each(&mut keep);
        }
        if !(6..=cells.len()).contains(&count) {
            self.faults.push(unreadable(
                line,
                format!(
                    "expected 6 to 10 values separated by commas, spaces or tabs, found {count}"
                ),
            ));
            return;
        }
        let has_class = self.is_truth && count == WITH_CLASS;
        let class = if has_class {
            self.number(line, &cells, 7)
        } else {
            Some(PEDESTRIAN)
        };
        let Some((id, one)) = self.object_box(line, &cells, count) else {
            return;
        };
        match class {
            None => {}
            Some(class) if has_class && (class != PEDESTRIAN || one.confidence == 0.0) => {
                let forgives = DISTRACTORS.contains(&class);
                self.others.push(OtherBox { one, forgives });
            }
            Some(_) if self.is_truth && one.confidence == 0.0 => self.without_confidence += 1,
            Some(_) => self.boxes.push((id, one, line)),
        }
    }

    /// The box of a row, and the number of its object; `None` after any fault.
    fn object_box(
        &mut self,
        line: u64,
        cells: &[&str; 10],
        count: usize,
    ) -> Option<(i64, ObjectBox)> {
        let frame = self.whole_number(line, cells, 0, 1);
        let id = if self.is_of_detector {
            Some(0)
        } else {
            self.whole_number(line, cells, 1, 0)
        };
        let [left_px, top_px, width_px, height_px] =
            [2, 3, 4, 5].map(|column| self.number(line, cells, column));
        let confidence = if count > 6 {
            self.number(line, cells, 6)
        } else {
            Some(1.0)
        };
        let (left_px, top_px, width_px, height_px) = (left_px?, top_px?, width_px?, height_px?);
        let (frame, confidence) = (u32::try_from(frame?).ok()?, confidence?);
        let one = ObjectBox {
            frame,
            object: 0,
            left_px,
            top_px,
            width_px,
            height_px,
            confidence,
        };
        let mut is_sound = true;
        for (field, code, detail) in one.faults() {
            self.faults
                .push(Fault::new("/file", code, detail).at(line, field));
            is_sound = false;
        }
        Some((id?, one)).filter(|_| is_sound)
    }

    fn number(&mut self, line: u64, cells: &[&str; 10], column: usize) -> Option<f64> {
        let (name, text) = (COLUMNS[column], cells[column]);
        let (code, detail) = match text.parse::<f64>() {
            Ok(value) if value.is_finite() => return Some(value),
            Ok(_) => ("not_finite", format!("'{text}' is not a finite number")),
            Err(_) if text.is_empty() => ("missing", format!("'{name}' is empty")),
            Err(_) => (
                "malformed",
                format!(
                    "expected a number, found '{}'",
                    text.chars().take(40).collect::<String>()
                ),
            ),
        };
        self.faults
            .push(Fault::new("/file", code, detail).at(line, name));
        None
    }

    /// Some writers put `7.0` for 7.
    fn whole_number(
        &mut self,
        line: u64,
        cells: &[&str; 10],
        column: usize,
        least: i64,
    ) -> Option<i64> {
        let value = self.number(line, cells, column)?;
        if value.fract() == 0.0 && (least as f64..=f64::from(u32::MAX)).contains(&value) {
            return Some(value as i64);
        }
        let code = if value.fract() == 0.0 {
            "out_of_range"
        } else {
            "malformed"
        };
        let detail = format!("expected a whole number, found '{}'", cells[column]);
        let fault = Fault::new("/file", code, detail).at(line, COLUMNS[column]);
        self.faults
            .push(fault.allowing(format!("{least} to {}", u32::MAX)));
        None
    }

    fn finish(mut self) -> Result<ReadOutcome, Vec<Fault>> {
        self.boxes
            .sort_by_key(|(id, one, line)| (one.frame, *id, *line));
        let mut repeats = Repeats::default();
        self.boxes.dedup_by(|next, one| {
            let is_repeated = (next.0, next.1) == (one.0, one.1);
            is_repeated.then(|| repeats.add(next.2));
            is_repeated
        });
        for pair in self
            .boxes
            .windows(2)
            .filter(|pair| (pair[0].0, pair[0].1.frame) == (pair[1].0, pair[1].1.frame))
        {
            let (id, one, line) = &pair[1];
            let detail = format!(
                "object {id} is in frame {} twice: also on line {}",
                one.frame, pair[0].2
            );
            self.faults
                .push(Fault::new("/file", "duplicate", detail).at(*line, "id"));
        }
        std::mem::take(&mut self.faults).finish()?;
        let (units, mut warnings) = self.told(&repeats);
        if self.boxes.is_empty() {
            warnings.push("there are no boxes: the dataset is empty".to_owned());
        }
        let numbers: BTreeMap<i64, ()> = self.boxes.iter().map(|(id, ..)| (*id, ())).collect();
        let indices: BTreeMap<i64, u32> = numbers.into_keys().zip(0..).collect();
        let boxes = self
            .boxes
            .iter()
            .map(|(id, one, _)| ObjectBox {
                object: indices[id],
                ..*one
            })
            .collect();
        let mut set = BoxSet::new(
            indices.into_keys().map(|id| id.to_string()).collect(),
            boxes,
        )?;
        set.add_others(self.others);
        let dataset = if self.is_truth {
            Dataset::TruthBoxes(set)
        } else {
            Dataset::TrackBoxes(set)
        };
        Ok(ReadOutcome {
            dataset,
            warnings,
            units,
        })
    }

    /// How the lines fared, and what a user is told of those that are left out.
    fn told(&self, repeats: &Repeats) -> (Units, Vec<String>) {
        let mut warnings = Vec::new();
        warnings.extend(repeats.warning("line"));
        let mut units = Units::called("line");
        units.use_up(self.boxes.len() as u64);
        let distractors = self.others.iter().filter(|other| other.forgives).count() as u64;
        let others = self.others.len() as u64 - distractors;
        for (count, what, why) in [
            (
                self.without_confidence,
                "confidence 0",
                "nobody has to find these",
            ),
            (
                others,
                "confidence 0 or another class",
                "tracks on them are false",
            ),
            (distractors, "distractor", "tracks on them are forgiven"),
            (repeats.count() as u64, "duplicate", ""),
        ] {
            if count == 0 {
                continue;
            }
            units.ignore(what, count);
            if !why.is_empty() {
                warnings.push(format!(
                    "{count} lines of truth are left out ({what}): {why}"
                ));
            }
        }
        (units, warnings)
    }

    fn finish_detections(self, frame_s: f64) -> Result<ReadOutcome, Vec<Fault>> {
        self.faults.finish()?;
        let boxes = self.boxes.into_iter().map(|(_, one, _)| one).collect();
        let dataset = mot_detections::recording(boxes, frame_s)?;
        let warnings = vec![format!(
            "a pixel is taken as a metre, a frame as {frame_s} s (`frame_s` says otherwise), the confidence as amplitude"
        )];
        Ok(ReadOutcome::all_used(dataset, warnings, "line"))
    }
}

fn unreadable(line: u64, detail: String) -> Fault {
    Fault {
        line: Some(line),
        ..Fault::new("/file", "malformed", detail)
    }
}

/// Writes boxes with ten values a row; reading them gives the same set when all objects are numbers and have boxes, and
/// for truth no confidence is 0.
///
/// # Errors
/// What the output says.
pub fn write_mot(set: &BoxSet, out: &mut dyn Write) -> io::Result<()> {
    let mut text = String::new();
    for one in set.boxes() {
        text.clear();
        text.push_str(&format!(
            "{},{}",
            one.frame,
            set.object_ids()[one.object as usize]
        ));
        for value in [
            one.left_px,
            one.top_px,
            one.width_px,
            one.height_px,
            one.confidence,
        ] {
            text.push(',');
            push_number(&mut text, value);
        }
        text.push_str(",-1,-1,-1\n");
        out.write_all(text.as_bytes())?;
    }
    Ok(())
}
