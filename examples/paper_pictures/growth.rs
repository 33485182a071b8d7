//! Run time of Liang's scenes over targets, from the rows of the example `liang_growth`.

use crate::chart::{Axis, Drawn, Panel, Point, Series, draw};
use crate::{ASSOCIATORS, log_axis};
use std::collections::HashMap;
use std::error::Error;
use std::path::Path;

/// Value and interval by cell and quantity.
struct Rows(HashMap<(String, String), [f64; 3]>);

impl Rows {
    fn read(file: &Path) -> Result<Self, Box<dyn Error>> {
        let mut rows = HashMap::new();
        for row in csv::Reader::from_path(file)?.records() {
            let row = row?;
            let value: f64 = row[3].parse()?;
            let end = |column: usize| row[column].parse().unwrap_or(value);
            rows.insert(
                (row[1].to_owned(), row[2].to_owned()),
                [value, end(4), end(5)],
            );
        }
        Ok(Rows(rows))
    }

    fn get(&self, cell: String, quantity: &str) -> Result<[f64; 3], Box<dyn Error>> {
        let found = self.0.get(&(cell.clone(), quantity.to_owned()));
        Ok(*found.ok_or_else(|| format!("there is no '{quantity}' of '{cell}'"))?)
    }
}

pub fn growth(folder: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    let rows = Rows::read(&folder.join("liang2009-growth.csv"))?;
    let time = "tracking and automaton, 30 scans (ms)";
    let small = panel(
        &rows,
        "10 to 100 targets in one square",
        &[10, 30, 50, 80, 100],
        log_axis("targets", [9.0, 112.0], &[10.0, 20.0, 30.0, 50.0, 100.0]),
        log_axis(time, [0.08, 3.0], &[0.1, 0.2, 0.5, 1.0, 2.0]),
    )?;
    let large = panel(
        &rows,
        "10 to 100 000 targets, at one density from 100 on",
        &[10, 30, 100, 1000, 3000, 10_000, 30_000, 100_000],
        log_axis("targets", [7.0, 150_000.0], &[10.0, 100.0, 1e3, 1e4, 1e5]),
        log_axis(time, [0.1, 6000.0], &[0.1, 1.0, 10.0, 100.0, 1000.0]),
    )?;
    draw(&out.join("liang-growth.svg"), &[small, large])
}

/// Measured times, and a line of slope 1 through the middle of the last associator's.
fn panel(
    rows: &Rows,
    title: &'static str,
    counts: &[u32],
    x: Axis,
    y: Axis,
) -> Result<Panel, Box<dyn Error>> {
    let (mut fits, mut dots) = (Vec::new(), Vec::new());
    let ends = [counts[0], counts[counts.len() - 1]];
    let mut linear = [exact(0.0, 0.0); 2];
    for (look, name) in ASSOCIATORS.iter().enumerate() {
        let mut points = Vec::new();
        for count in counts {
            let [time_ms, ..] = rows.get(format!("{count}, {name}"), "both ms")?;
            points.push(exact(f64::from(*count).log10(), time_ms.log10()));
        }
        let slopes = rows.get(
            format!("{} to {}, {name}", ends[0], ends[1]),
            "slope of both",
        )?;
        let middle = middle(&points);
        linear = ends.map(|x| on_line(middle, f64::from(x).log10(), [1.0; 3]));
        fits.push(fit(look, name, middle, &points, slopes));
        dots.push(Series {
            name: format!("{name}, measured"),
            look,
            drawn: Drawn::Dots,
            points,
        });
    }
    fits.push(Series {
        name: "linear: slope 1".to_owned(),
        look: 5,
        drawn: Drawn::Rule,
        points: linear.to_vec(),
    });
    fits.append(&mut dots);
    Ok(Panel {
        title,
        x,
        y,
        series: fits,
    })
}

/// The fitted line with the slopes of its interval through the middle of the points.
fn fit(look: usize, name: &str, middle: Point, points: &[Point], slopes: [f64; 3]) -> Series {
    let ends = [points[0].x, middle.x, points[points.len() - 1].x];
    let [slope, low, high] = slopes;
    Series {
        name: format!("{name}: slope {slope:.2} ({low:.2} to {high:.2})"),
        look,
        drawn: Drawn::Fit,
        points: ends.map(|x| on_line(middle, x, slopes)).to_vec(),
    }
}

fn on_line(middle: Point, x: f64, slopes: [f64; 3]) -> Point {
    let [y, low, high] = slopes.map(|slope| middle.y + slope * (x - middle.x));
    Point { x, y, low, high }
}

fn middle(points: &[Point]) -> Point {
    let count = points.len() as f64;
    exact(
        points.iter().map(|point| point.x).sum::<f64>() / count,
        points.iter().map(|point| point.y).sum::<f64>() / count,
    )
}

fn exact(x: f64, y: f64) -> Point {
    Point {
        x,
        y,
        low: y,
        high: y,
    }
}
