//! A bearing-time record as a picture, `record.svg`: levels as shades, time downwards, detections and tracks over it. Large records
//! are drawn with the mean power of blocks of cells.

use crate::experiment::job::Artifact;
use crate::model::bearing_time::BearingTimeRecord;
use crate::model::scan::{Measurement, Recording};
use crate::model::space::Space;
use crate::model::track::{Track, TrackSet};
use std::f64::consts::TAU;
use std::fmt::Write;

const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 680.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 46.0;
const PLOT_WIDTH: f64 = 800.0;
const PLOT_HEIGHT: f64 = 570.0;
/// Blocks of the picture, at most.
const MOST_COLUMNS: usize = 400;
const MOST_ROWS: usize = 190;
const SHADES: usize = 20;
/// Shares of the blocks that are paler than the palest shade and darker than the darkest.
const PALEST: f64 = 0.3;
const DARKEST: f64 = 0.995;
/// Longer texts are cut off.
const MOST_DETECTIONS: usize = 20_000;

/// Draws the record and what was made of it.
pub fn draw(
    record: &BearingTimeRecord,
    recording: Option<&Recording>,
    tracks: Option<&TrackSet>,
) -> Artifact {
    let frame = Frame::of(record);
    let mut svg = String::new();
    put(
        &mut svg,
        format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
             font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n"
        ),
    );
    let scale = add_levels(&mut svg, record);
    add_axes(&mut svg, &frame);
    if let Some((low_db, high_db)) = scale {
        add_scale(&mut svg, low_db, high_db);
    }
    if let Some(recording) = recording {
        add_detections(&mut svg, &frame, recording);
    }
    if let Some(set) = tracks {
        for track in &set.tracks {
            add_track(&mut svg, &frame, set.space, track);
        }
    }
    add_legend(&mut svg, recording.is_some(), tracks.is_some());
    svg.push_str("</svg>\n");
    Artifact::file("record.svg", "image/svg+xml", svg.into_bytes())
}

fn put(svg: &mut String, text: std::fmt::Arguments) {
    let written = svg.write_fmt(text);
    debug_assert!(written.is_ok(), "a String takes any text");
}

/// Where bearings and times are in the picture.
struct Frame {
    first_rad: f64,
    span_rad: f64,
    first_s: f64,
    span_s: f64,
}

impl Frame {
    fn of(record: &BearingTimeRecord) -> Frame {
        let step_s = record.time_step_s().unwrap_or(1.0);
        let last_s = record.times_s[record.times_s.len() - 1];
        Frame {
            first_rad: record.bearings_rad[0] - record.cell_rad() / 2.0,
            span_rad: record.span_rad(),
            first_s: record.times_s[0] - step_s / 2.0,
            span_s: last_s - record.times_s[0] + step_s,
        }
    }

    /// `None` outside the record.
    fn x(&self, bearing_rad: f64) -> Option<f64> {
        let share = (bearing_rad - self.first_rad).rem_euclid(TAU) / self.span_rad;
        (share <= 1.0).then_some(LEFT + PLOT_WIDTH * share)
    }

    fn y(&self, time_s: f64) -> f64 {
        TOP + PLOT_HEIGHT * (time_s - self.first_s) / self.span_s
    }
}

/// The shades, one path each; the levels of the palest and of the darkest, `None` where all are equal.
fn add_levels(svg: &mut String, record: &BearingTimeRecord) -> Option<(f64, f64)> {
    let (blocks, columns) = blocks(record);
    let rows = blocks.len() / columns;
    let mut sorted = blocks.clone();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
    let (low_db, high_db) = (at(PALEST), at(DARKEST));
    let (width, height) = (PLOT_WIDTH / columns as f64, PLOT_HEIGHT / rows as f64);
    put(
        svg,
        format_args!(
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{PLOT_WIDTH}\" height=\"{PLOT_HEIGHT}\" fill=\"{}\"/>\n",
            shade(0)
        ),
    );
    if high_db <= low_db {
        return None;
    }
    let step = |level_db: f64| {
        (((level_db - low_db) / (high_db - low_db) * SHADES as f64).max(0.0) as usize)
            .min(SHADES - 1)
    };
    let steps: Vec<usize> = blocks.iter().map(|&level_db| step(level_db)).collect();
    put(
        svg,
        format_args!(
            "<g transform=\"translate({LEFT} {TOP}) scale({width:.5} {height:.5})\" shape-rendering=\"crispEdges\">\n"
        ),
    );
    for wanted in 1..SHADES {
        let mut path = String::new();
        for (row, cells) in steps.chunks_exact(columns).enumerate() {
            let mut column = 0;
            while column < columns {
                let run = cells[column..]
                    .iter()
                    .take_while(|&&found| found == wanted)
                    .count();
                if run > 0 {
                    put(&mut path, format_args!("M{column} {row}h{run}v1h-{run}z"));
                }
                column += run.max(1);
            }
        }
        if !path.is_empty() {
            put(
                svg,
                format_args!("<path fill=\"{}\" d=\"{path}\"/>\n", shade(wanted)),
            );
        }
    }
    svg.push_str("</g>\n");
    Some((low_db, high_db))
}

/// Levels of blocks of cells, row by row, and the blocks of a row.
fn blocks(record: &BearingTimeRecord) -> (Vec<f64>, usize) {
    let (cells, times) = (record.width(), record.times_s.len());
    let (columns, rows) = (cells.min(MOST_COLUMNS), times.min(MOST_ROWS));
    let mut sums = vec![0.0; columns * rows];
    let mut counts = vec![0.0; columns * rows];
    for time in 0..times {
        for (cell, &level_db) in record.row(time).iter().enumerate() {
            let block = time * rows / times * columns + cell * columns / cells;
            sums[block] += 10f64.powf(f64::from(level_db) / 10.0);
            counts[block] += 1.0;
        }
    }
    (
        sums.iter()
            .zip(&counts)
            .map(|(sum, count)| 10.0 * (sum / count).max(1e-30).log10())
            .collect(),
        columns,
    )
}

/// From nearly white to dark blue.
fn shade(step: usize) -> String {
    let share = step as f64 / (SHADES - 1) as f64;
    let mix = |pale: f64, dark: f64| (pale + (dark - pale) * share).round() as u8;
    format!(
        "#{:02x}{:02x}{:02x}",
        mix(247.0, 8.0),
        mix(250.0, 48.0),
        mix(254.0, 107.0)
    )
}

fn add_axes(svg: &mut String, frame: &Frame) {
    let (right, bottom) = (LEFT + PLOT_WIDTH, TOP + PLOT_HEIGHT);
    put(
        svg,
        format_args!(
            "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{PLOT_WIDTH}\" height=\"{PLOT_HEIGHT}\" fill=\"none\" stroke=\"#444\"/>\n\
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">Bearing (deg)</text>\n\
             <text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">Time (s)</text>\n",
            (LEFT + right) / 2.0,
            bottom + 42.0,
            (TOP + bottom) / 2.0
        ),
    );
    for value in ticks(
        frame.first_rad.to_degrees(),
        frame.span_rad.to_degrees(),
        &[1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0],
    ) {
        let x = LEFT + PLOT_WIDTH * (value.to_radians() - frame.first_rad) / frame.span_rad;
        let label = value.rem_euclid(360.0);
        put(
            svg,
            format_args!(
                "<path d=\"M{x:.1} {bottom}v5\" stroke=\"#444\"/><text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>\n",
                bottom + 20.0
            ),
        );
    }
    for value in ticks(frame.first_s, frame.span_s, &[]) {
        let y = frame.y(value);
        put(
            svg,
            format_args!(
                "<path d=\"M{LEFT} {y:.1}h-5\" stroke=\"#444\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{value}</text>\n",
                LEFT - 9.0,
                y + 4.5
            ),
        );
    }
}

/// Round values in an interval, ten or fewer: multiples of one of `steps`, or of 1, 2 or 5 times a power of ten.
fn ticks(first: f64, span: f64, steps: &[f64]) -> Vec<f64> {
    const MOST: f64 = 10.0;
    let power = 10f64.powf((span / MOST).log10().floor());
    let decimal = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    let is_enough = |step: &&f64| span / **step <= MOST;
    let step = steps
        .iter()
        .find(is_enough)
        .or_else(|| decimal.iter().find(is_enough))
        .copied()
        .unwrap_or(span);
    let number = |value: f64| (value / step).ceil() as i64;
    // Of 0.1 and the like, the nearest value that is written shortly.
    (number(first)..)
        .map(|index| (index as f64 * step * 1e6).round() / 1e6)
        .take_while(|value| *value <= first + span)
        .collect()
}

fn add_scale(svg: &mut String, low_db: f64, high_db: f64) {
    let (x, height) = (LEFT + PLOT_WIDTH + 24.0, 200.0 / SHADES as f64);
    for step in 0..SHADES {
        let y = TOP + 24.0 + height * (SHADES - 1 - step) as f64;
        put(
            svg,
            format_args!(
                "<rect x=\"{x}\" y=\"{y:.1}\" width=\"18\" height=\"{:.1}\" fill=\"{}\"/>\n",
                height + 0.5,
                shade(step)
            ),
        );
    }
    put(
        svg,
        format_args!(
            "<rect x=\"{x}\" y=\"{}\" width=\"18\" height=\"200\" fill=\"none\" stroke=\"#444\"/>\n\
             <text x=\"{x}\" y=\"{}\">Level (dB)</text>\n",
            TOP + 24.0,
            TOP + 12.0
        ),
    );
    for value in ticks(low_db, high_db - low_db, &[]) {
        let y = TOP + 24.0 + 200.0 * (high_db - value) / (high_db - low_db);
        put(
            svg,
            format_args!(
                "<path d=\"M{} {y:.1}h5\" stroke=\"#444\"/><text x=\"{}\" y=\"{:.1}\">{value}</text>\n",
                x + 18.0,
                x + 27.0,
                y + 4.5
            ),
        );
    }
}

fn add_detections(svg: &mut String, frame: &Frame, recording: &Recording) {
    svg.push_str("<g fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"0.9\">\n");
    let all = recording.scans.iter().flat_map(|scan| {
        scan.detections
            .iter()
            .map(move |found| (scan.time_s, found))
    });
    for (time_s, detection) in all.take(MOST_DETECTIONS) {
        if let Measurement::Bearing { bearing_rad } = detection.measurement
            && let Some(x) = frame.x(bearing_rad)
        {
            put(
                svg,
                format_args!(
                    "<circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"2.2\"/>\n",
                    frame.y(time_s)
                ),
            );
        }
    }
    svg.push_str("</g>\n");
}

const TRACK: &str = "#e4371e";

/// The line of a track, broken where it goes round, and its name.
fn add_track(svg: &mut String, frame: &Frame, space: Space, track: &Track) {
    let place = |point: &crate::model::track::TrackPoint| {
        let bearing_rad = (space == Space::Bearing).then_some(point.estimate.position.x)?;
        let x = frame.x(bearing_rad)?;
        Some((x, frame.y(point.time_s)))
    };
    let mut path = String::new();
    let mut last: Option<f64> = None;
    for point in &track.points {
        let Some((x, y)) = place(point) else {
            last = None;
            continue;
        };
        let goes_on = last.is_some_and(|last| (x - last).abs() < PLOT_WIDTH / 2.0);
        put(
            &mut path,
            format_args!("{}{x:.1} {y:.1}", if goes_on { 'L' } else { 'M' }),
        );
        last = Some(x);
    }
    put(
        svg,
        format_args!(
            "<path fill=\"none\" stroke=\"{TRACK}\" stroke-width=\"1.8\" d=\"{path}\"/>\n"
        ),
    );
    if let Some((x, y)) = track.points.first().and_then(place) {
        put(
            svg,
            format_args!(
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-weight=\"bold\" fill=\"{TRACK}\">{}</text>\n",
                y - 6.0,
                escape(&track.track_id)
            ),
        );
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

fn add_legend(svg: &mut String, has_detections: bool, has_tracks: bool) {
    let (x, y) = (LEFT + PLOT_WIDTH + 24.0, TOP + 260.0);
    if has_detections {
        put(
            svg,
            format_args!(
                "<circle cx=\"{}\" cy=\"{y}\" r=\"2.2\" fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"0.9\"/>\
                 <text x=\"{}\" y=\"{}\">detection</text>\n",
                x + 8.0,
                x + 22.0,
                y + 4.5
            ),
        );
    }
    if has_tracks {
        put(
            svg,
            format_args!(
                "<path d=\"M{x} {}h16\" stroke=\"{TRACK}\" stroke-width=\"1.8\"/><text x=\"{}\" y=\"{}\">track</text>\n",
                y + 22.0,
                x + 22.0,
                y + 26.5
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::bearing_time::BearingTimeParts;

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(
            ticks(-0.5, 360.0, &[10.0, 45.0]),
            [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0]
        );
        assert_eq!(
            ticks(0.0, 0.9, &[]),
            [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
        );
        assert_eq!(
            ticks(95.0, 900.0, &[]),
            [
                100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0
            ]
        );
    }

    #[test]
    fn a_bearing_beyond_the_last_cell_of_a_turn_is_at_its_beginning() {
        let record = BearingTimeRecord::new(BearingTimeParts {
            times_s: vec![0.0, 1.0],
            bearings_rad: (0..4)
                .map(|cell| f64::from(90 * cell).to_radians())
                .collect(),
            levels_db: vec![0.0; 8],
        });
        let frame = Frame::of(&record.unwrap());
        let x = |degrees: f64| frame.x(degrees.to_radians()).unwrap();
        assert!(
            (x(0.0) - (LEFT + PLOT_WIDTH / 8.0)).abs() < 1e-9
                && (x(330.0) - (LEFT + PLOT_WIDTH * 15.0 / 360.0)).abs() < 1e-9
        );
        assert!((frame.y(0.0) - (TOP + PLOT_HEIGHT / 4.0)).abs() < 1e-9);
    }
}
