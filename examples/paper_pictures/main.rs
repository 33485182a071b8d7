//! The pictures of `docs/papers.md`, from what the campaigns and `liang_growth` leave in a folder: `docs/data/make.py` runs them all.
//!
//! `cargo run --release -p trackloom-domain --example paper_pictures -- papers docs/pictures`
//!
//! Bands and bars are 95 % intervals.

mod chart;
mod growth;
mod wang;

use chart::{Axis, Drawn, Panel, Point, Series, draw};
use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::path::Path;

/// `cells.csv` of a campaign: mean and interval by cell and outcome.
struct Cells(HashMap<(String, String), [f64; 3]>);

impl Cells {
    fn of(bytes: &[u8]) -> Result<Self, Box<dyn Error>> {
        let mut cells = HashMap::new();
        for row in csv::Reader::from_reader(bytes).records() {
            let row = row?;
            let number = |column: usize| row[column].parse::<f64>();
            if let (Ok(mean), Ok(low), Ok(high)) = (number(4), number(5), number(6)) {
                cells.insert((row[0].to_owned(), row[1].to_owned()), [mean, low, high]);
            }
        }
        Ok(Cells(cells))
    }

    fn of_campaign(folder: &Path, name: &str) -> Result<Self, Box<dyn Error>> {
        Cells::of(&fs::read(folder.join(name).join("cells.csv"))?)
    }

    /// The outcome in a cell, its numbers times `unit`.
    fn point(&self, x: f64, cell: &str, outcome: &str, unit: f64) -> Result<Point, Box<dyn Error>> {
        let found = self.0.get(&(cell.to_owned(), outcome.to_owned()));
        let [mean, low, high] = found
            .ok_or_else(|| format!("there is no '{outcome}' of the cell '{cell}'"))?
            .map(|number| number * unit);
        Ok(Point {
            x,
            y: mean,
            low,
            high,
        })
    }

    fn series(
        &self,
        name: &str,
        (look, drawn): (usize, Drawn),
        outcome: (&str, f64),
        cells: impl Iterator<Item = (f64, String)>,
    ) -> Result<Series, Box<dyn Error>> {
        let points = cells
            .map(|(x, cell)| self.point(x, &cell, outcome.0, outcome.1))
            .collect::<Result<_, _>>()?;
        Ok(Series {
            name: name.to_owned(),
            look,
            drawn,
            points,
        })
    }
}

fn axis(title: &'static str, range: [f64; 2], ticks: &[f64]) -> Axis {
    Axis {
        title,
        range,
        ticks: ticks.iter().map(|&tick| (tick, tick.to_string())).collect(),
    }
}

/// A decimal logarithm.
fn log_axis(title: &'static str, range: [f64; 2], ticks: &[f64]) -> Axis {
    Axis {
        title,
        range: range.map(f64::log10),
        ticks: ticks
            .iter()
            .map(|&tick| (tick.log10(), tick.to_string()))
            .collect(),
    }
}

fn named_axis(title: &'static str, names: &[&str]) -> Axis {
    let ticks = names
        .iter()
        .enumerate()
        .map(|(place, name)| (place as f64, (*name).to_owned()));
    Axis {
        title,
        range: [-0.5, names.len() as f64 - 0.5],
        ticks: ticks.collect(),
    }
}

fn percent(title: &'static str, low: f64, step: f64) -> Axis {
    let count = ((100.0 - low) / step).round() as u32;
    let ticks: Vec<f64> = (0..=count)
        .map(|number| low + f64::from(number) * step)
        .collect();
    axis(title, [low, 100.0 + step * 0.2], &ticks)
}

const ASSOCIATORS: [&str; 3] = ["NN", "PDA", "JPDA"];

/// Figures 1 and 2, and the tracks there are for a target.
fn liang(folder: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    let cells = Cells::of_campaign(folder, "liang2009-table1")?;
    let counts = [10.0, 30.0, 50.0, 80.0, 100.0];
    let picture =
        |file: &str, title: &'static str, outcome: (&str, f64), y: Axis, more: Option<Series>| {
            let of = |(look, name): (usize, &&str)| {
                // PDA and JPDA are alike: a little to the side, or one would hide the other.
                let aside = [0.0, -0.5, 0.5][look];
                cells.series(
                    name,
                    (look, Drawn::Curve),
                    outcome,
                    counts
                        .iter()
                        .map(|count| (count + aside, format!("{count}, {name}"))),
                )
            };
            let series = ASSOCIATORS
                .iter()
                .enumerate()
                .map(of)
                .chain(more.map(Ok))
                .collect::<Result<_, Box<dyn Error>>>()?;
            draw(
                &out.join(file),
                &[Panel {
                    title,
                    x: axis("targets", [5.0, 105.0], &counts),
                    y,
                    series,
                }],
            )
        };
    picture(
        "liang-figure-1.svg",
        "Correct tracks",
        ("P correct", 100.0),
        percent("correct tracks of all tracks (%)", 40.0, 10.0),
        None,
    )?;
    picture(
        "liang-figure-2.svg",
        "Missed targets",
        ("P missed", 100.0),
        axis(
            "missed targets of all targets (%)",
            [20.0, 65.0],
            &[20.0, 30.0, 40.0, 50.0, 60.0],
        ),
        None,
    )?;
    let one = [5.0, 105.0].map(|x| Point {
        x,
        y: 1.0,
        low: 1.0,
        high: 1.0,
    });
    let as_many = Series {
        name: "as many tracks as targets".to_owned(),
        look: 5,
        drawn: Drawn::Rule,
        points: one.to_vec(),
    };
    picture(
        "liang-tracks.svg",
        "Tracks put out",
        ("tracks per target", 1.0),
        axis("tracks a target", [0.7, 1.05], &[0.7, 0.8, 0.9, 1.0]),
        Some(as_many),
    )
}

/// Shares put together exactly, and what the paper has.
fn cai(folder: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    let cells = Cells::of_campaign(folder, "cai-fuzzy-tables")?;
    let scenes = ["cv, 10", "cv, 15", "weave, 10", "weave, 15"];
    let groupers = [
        ("NN, 3 σ", -0.24),
        ("FCM from predictions", -0.08),
        ("NN, no gate", 0.08),
        ("constrained hard c-means", 0.24),
    ];
    let of = |(look, (name, aside)): (usize, &(&str, f64))| {
        let cells_of = scenes
            .iter()
            .enumerate()
            .map(|(place, scene)| (place as f64 + aside, format!("{scene}, {name}")));
        cells.series(name, (look, Drawn::Dots), ("accuracy", 100.0), cells_of)
    };
    let mut series = groupers
        .iter()
        .enumerate()
        .map(of)
        .collect::<Result<Vec<_>, _>>()?;
    for (look, name, values) in [
        (0, "NN, as published", [95.0, 93.0, 85.0, 76.0]),
        (1, "FCM, as published", [100.0, 100.0, 93.0, 91.0]),
    ] {
        let points = values.iter().enumerate().map(|(place, &y)| Point {
            x: place as f64 + groupers[look].1,
            y,
            low: y,
            high: y,
        });
        series.push(Series {
            name: name.to_owned(),
            look,
            drawn: Drawn::Published,
            points: points.collect(),
        });
    }
    let x = named_axis(
        "motion, targets of 25 that all six sensors report",
        &["straight, 10", "straight, 15", "weaving, 10", "weaving, 15"],
    );
    draw(
        &out.join("cai-accuracy.svg"),
        &[Panel {
            title: "Reports of a target put together exactly",
            x,
            y: percent("share of targets (%)", 70.0, 5.0),
            series,
        }],
    )
}

/// Cost and correctness over size; all with P_D 0.9.
fn huo(folder: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    let cells = Cells::of_campaign(folder, "huo2008-study")?;
    let settings = ["P_D 0.9", "3 × 50, P_D 0.9", "5 × 50, P_D 0.9"];
    let methods = [
        ("exact", -0.3),
        ("genetic, the paper's coding", -0.18),
        ("genetic", -0.06),
        ("nearest", 0.06),
        ("weighted", 0.18),
        ("fuzzy", 0.3),
    ];
    let panel = |title: &'static str, outcome: &str, y: Axis| -> Result<Panel, Box<dyn Error>> {
        let of = |(look, (name, aside)): (usize, &(&str, f64))| {
            let cells_of = settings
                .iter()
                .enumerate()
                .map(|(place, setting)| (place as f64 + aside, format!("{setting}, {name}")));
            cells.series(name, (look, Drawn::Dots), (outcome, 100.0), cells_of)
        };
        let series = methods
            .iter()
            .enumerate()
            .map(of)
            .collect::<Result<_, _>>()?;
        Ok(Panel {
            title,
            x: named_axis(
                "sensors × targets, P_D 0.9",
                &["3 × 10", "3 × 50", "5 × 50"],
            ),
            y,
            series,
        })
    };
    let cost = panel(
        "Cost above the least (chain)",
        "gap",
        axis(
            "(J − J*) / |J*| (%)",
            [-4.0, 85.0],
            &[0.0, 20.0, 40.0, 60.0, 80.0],
        ),
    )?;
    let right = panel(
        "Tuples that are right",
        "tuples right",
        axis(
            "share of targets (%)",
            [-4.0, 104.0],
            &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0],
        ),
    )?;
    draw(&out.join("huo-size.svg"), &[cost, right])
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (folder, out) = (
        arguments.next().unwrap_or_else(|| "papers".to_owned()),
        arguments
            .next()
            .unwrap_or_else(|| "docs/pictures".to_owned()),
    );
    let (folder, out) = (Path::new(&folder), Path::new(&out));
    fs::create_dir_all(out)?;
    wang::figures(out)?;
    wang::eta_over_noise(folder, out)?;
    wang::eta(folder, out)?;
    liang(folder, out)?;
    growth::growth(folder, out)?;
    cai(folder, out)?;
    huo(folder, out)
}
