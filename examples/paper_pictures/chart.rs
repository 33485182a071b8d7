//! Charts of points with intervals, as SVG: a white ground, colours that the colour-blind tell apart, and markers and dashes besides.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// Okabe and Ito's colours, the darker first.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(70, 70, 70),
];
/// Dash and gap in pixels; no gap is a line without dashes.
const DASHES: [(u32, u32); 6] = [(1, 0), (12, 5), (4, 4), (18, 4), (7, 3), (2, 3)];
/// Corners of the markers in pixels; the first is a circle instead.
const MARKERS: [&[(i32, i32)]; 6] = [
    &[],
    &[(0, -7), (6, 4), (-6, 4)],
    &[(-4, -4), (4, -4), (4, 4), (-4, 4)],
    &[(0, -6), (6, 0), (0, 6), (-6, 0)],
    &[(0, 7), (6, -4), (-6, -4)],
    &[(-6, -2), (6, -2), (6, 2), (-6, 2)],
];
const GREY: RGBColor = RGBColor(110, 110, 110);
/// Of a legend.
const COLUMNS: usize = 2;
const ROW: u32 = 24;
const TEXT: (&str, u32) = ("sans-serif", 16);

#[derive(Clone)]
pub struct Axis {
    pub title: &'static str,
    pub range: [f64; 2],
    pub ticks: Vec<(f64, String)>,
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let share = (value - self.range[0]) / (self.range[1] - self.range[0]);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            Vec::new()
        } else {
            self.ticks.iter().map(|tick| tick.0).collect()
        }
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.ticks
            .iter()
            .find(|tick| tick.0 == *value)
            .map_or_else(String::new, |tick| tick.1.clone())
    }
}

#[derive(Clone, Copy)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    /// Ends of the interval.
    pub low: f64,
    pub high: f64,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Drawn {
    /// A line with a band and markers.
    Curve,
    /// A line with a band.
    Fit,
    /// Markers with bars.
    Dots,
    /// Hollow markers, what a paper says.
    Published,
    /// A thin grey line to compare with.
    Rule,
}

pub struct Series {
    pub name: String,
    /// Colour, dash and marker.
    pub look: usize,
    pub drawn: Drawn,
    pub points: Vec<Point>,
}

pub struct Panel {
    pub title: &'static str,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
}

/// Panels side by side, each with its legend below.
pub fn draw(path: &Path, panels: &[Panel]) -> Result<(), Box<dyn Error>> {
    let width = if panels.len() > 1 { 560 } else { 720 };
    let rows = panels
        .iter()
        .map(|panel| panel.series.len().div_ceil(COLUMNS))
        .max()
        .unwrap_or(0) as u32;
    let root = SVGBackend::new(path, (width * panels.len() as u32, 420 + rows * ROW + 12))
        .into_drawing_area();
    root.fill(&WHITE)?;
    for (area, panel) in root.split_evenly((1, panels.len())).iter().zip(panels) {
        let (area, below) = area.split_vertically(420);
        draw_legend(&below, &panel.series, width)?;
        let mut chart = ChartBuilder::on(&area)
            .margin(14)
            .margin_right(22)
            .caption(panel.title, ("sans-serif", 18))
            .x_label_area_size(52)
            .y_label_area_size(68)
            .build_cartesian_2d(panel.x.clone(), panel.y.clone())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .label_style(TEXT)
            .axis_desc_style(TEXT)
            .x_desc(panel.x.title)
            .y_desc(panel.y.title)
            .draw()?;
        for series in &panel.series {
            add(&mut chart, series)?;
        }
    }
    Ok(root.present()?)
}

fn draw_legend(
    area: &DrawingArea<SVGBackend, Shift>,
    series: &[Series],
    width: u32,
) -> Result<(), Box<dyn Error>> {
    let rows = series.len().div_ceil(COLUMNS);
    for (
        index,
        Series {
            name, look, drawn, ..
        },
    ) in series.iter().enumerate()
    {
        let left = 68 + (index / rows) as i32 * ((width - 68) / COLUMNS as u32) as i32;
        let middle = (index % rows) as i32 * ROW as i32 + ROW as i32 / 2;
        let colour = if *drawn == Drawn::Rule {
            GREY
        } else {
            COLOURS[*look]
        };
        let [has_line, has_marker] = parts(*drawn);
        if has_line {
            let (line, style) = (
                [(left, middle), (left + 40, middle)],
                colour.stroke_width(2),
            );
            match DASHES[*look] {
                (_, 0) => area.draw(&PathElement::new(line, style))?,
                (dash, gap) => area.draw(&DashedPathElement::new(line, dash, gap, style))?,
            }
        }
        if has_marker {
            draw_marker(area, *look, (left + 20, middle), *drawn == Drawn::Published)?;
        }
        area.draw(&Text::new(name.clone(), (left + 50, middle - 8), TEXT))?;
    }
    Ok(())
}

fn add(chart: &mut Chart, series: &Series) -> Result<(), Box<dyn Error>> {
    let Series {
        look,
        drawn,
        points,
        ..
    } = series;
    let (look, drawn) = (*look, *drawn);
    let colour = if drawn == Drawn::Rule {
        GREY
    } else {
        COLOURS[look]
    };
    if matches!(drawn, Drawn::Curve | Drawn::Fit) {
        let around = points
            .iter()
            .map(|point| (point.x, point.low))
            .chain(points.iter().rev().map(|point| (point.x, point.high)));
        chart.draw_series([Polygon::new(around.collect::<Vec<_>>(), colour.mix(0.18))])?;
    }
    let [has_line, has_marker] = parts(drawn);
    if has_line {
        let line: Vec<(f64, f64)> = points.iter().map(|point| (point.x, point.y)).collect();
        let width = if drawn == Drawn::Rule { 1 } else { 2 };
        let style = colour.stroke_width(width);
        match DASHES[look] {
            (_, 0) => chart.draw_series(LineSeries::new(line, style))?,
            (dash, gap) => chart.draw_series(DashedLineSeries::new(line, dash, gap, style))?,
        };
    }
    if drawn == Drawn::Dots {
        let bars = points.iter().map(|point| {
            PathElement::new(
                vec![(point.x, point.low), (point.x, point.high)],
                colour.stroke_width(2),
            )
        });
        chart.draw_series(bars)?;
    }
    if has_marker {
        let area = chart.plotting_area().strip_coord_spec();
        let base = area.get_base_pixel();
        for point in points {
            let (x, y) = chart.backend_coord(&(point.x, point.y));
            draw_marker(
                &area,
                look,
                (x - base.0, y - base.1),
                drawn == Drawn::Published,
            )?;
        }
    }
    Ok(())
}

/// Whether there is a line, and whether there are markers.
fn parts(drawn: Drawn) -> [bool; 2] {
    [
        matches!(drawn, Drawn::Curve | Drawn::Fit | Drawn::Rule),
        matches!(drawn, Drawn::Curve | Drawn::Dots | Drawn::Published),
    ]
}

fn draw_marker(
    area: &DrawingArea<SVGBackend, Shift>,
    look: usize,
    (x, y): (i32, i32),
    is_hollow: bool,
) -> Result<(), Box<dyn Error>> {
    let colour = COLOURS[look];
    let placed = |corner: &(i32, i32)| (x + corner.0, y + corner.1);
    let corners: Vec<(i32, i32)> = MARKERS[look].iter().map(placed).collect();
    let style = if is_hollow {
        colour.stroke_width(2)
    } else {
        colour.filled()
    };
    match (corners.as_slice(), is_hollow) {
        ([], _) => area.draw(&Circle::new((x, y), 5, style))?,
        ([first, ..], true) => area.draw(&PathElement::new(
            [corners.as_slice(), &[*first]].concat(),
            style,
        ))?,
        (_, false) => area.draw(&Polygon::new(corners, style))?,
    }
    Ok(())
}
