//! Figures 1 to 5 of Wang, Li, Huang: the echoes of two targets, the tracks of three associators, six targets, and the record of the
//! sea trial without and with its tracks; and η over clutter, targets and crossings.

use crate::Cells;
use crate::chart::{Axis, Drawn, Panel, Point, Series, draw};
use serde_json::{Value, json};
use std::error::Error;
use std::fs;
use std::path::Path;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{JobKind, Outcome, plan, presets, run};

pub fn figures(out: &Path) -> Result<(), Box<dyn Error>> {
    two_targets(out)?;
    six_targets(out)?;
    sea_trial(out)
}

/// Figures 1 and 2, of the first run in which nearest neighbour loses a target and the others do not.
fn two_targets(out: &Path) -> Result<(), Box<dyn Error>> {
    let mut scene = scene("wang-bat-2")?;
    scene["input"]["scenario"]["sensors"][0]["sigma_bearing_deg"] = json!(0.6);
    let contenders = [
        (
            "NN (two tracks may take one detection)",
            json!({"method": "nearest_neighbour", "conflicts": "shared"}),
        ),
        ("JPDA", json!({"method": "jpda"})),
        ("BADA", json!({"method": "bat"})),
    ];
    for seed in 1..1000 {
        scene["seed"] = json!(seed);
        let mut found = Vec::new();
        for (_, associator) in &contenders {
            found.push(evaluated(&scene, associator)?);
        }
        if found.iter().map(is_kept).eq([false, true, true]) {
            let echoes = Panel {
                title: "Echoes of two targets, σ 0.6°",
                x: time_axis(),
                y: bearing_axis(245.0, 285.0),
                series: echoes(&found[0], 2, 1)?,
            };
            draw(&out.join("wang-figure-1.svg"), &[echoes])?;
            let mut panels = Vec::new();
            for ((title, _), outcome) in contenders.iter().zip(&found) {
                let mut series = courses(outcome, "truth.csv", "truth_id", "target", Drawn::Rule)?;
                series.extend(courses(
                    outcome,
                    "tracks.csv",
                    "track_id",
                    "track",
                    Drawn::Fit,
                )?);
                panels.push(Panel {
                    title,
                    x: time_axis(),
                    y: bearing_axis(245.0, 285.0),
                    series,
                });
            }
            return draw(&out.join("wang-figure-2.svg"), &panels);
        }
    }
    Err("no run loses a target by nearest neighbour alone".into())
}

/// Figure 3, of the first run that the bats keep.
fn six_targets(out: &Path) -> Result<(), Box<dyn Error>> {
    let mut scene = scene("wang-bat-6")?;
    for seed in 1..1000 {
        scene["seed"] = json!(seed);
        let outcome = evaluated(&scene, &json!({"method": "bat"}))?;
        if is_kept(&outcome) {
            // All of them would hide the tracks.
            let mut series = echoes(&outcome, 6, 6)?;
            series.extend(courses(
                &outcome,
                "tracks.csv",
                "track_id",
                "track",
                Drawn::Fit,
            )?);
            let panel = Panel {
                title: "Six targets tracked by BADA, σ 0.35°",
                x: time_axis(),
                y: bearing_axis(180.0, 320.0),
                series,
            };
            return draw(&out.join("wang-figure-3.svg"), &[panel]);
        }
    }
    Err("no run keeps six targets".into())
}

/// Figures 4 and 5. Figure 4 is what lies below the detections of Figure 5.
fn sea_trial(out: &Path) -> Result<(), Box<dyn Error>> {
    let preset =
        presets::find("wang-bat-sea-trial").ok_or("there is no preset of the sea trial")?;
    let outcome = done(preset.kind, &preset.body)?;
    let tracked = file(&outcome, "record.svg")?;
    let levels = tracked
        .split("<g fill=\"#ffffff\" stroke")
        .next()
        .unwrap_or_default();
    fs::write(out.join("wang-figure-4.svg"), format!("{levels}</svg>\n"))?;
    Ok(fs::write(out.join("wang-figure-5.svg"), tracked)?)
}

/// η over the noise of a bearing, by both definitions of a kept run.
pub fn eta_over_noise(folder: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    let cells = Cells::of_campaign(folder, "wang-bat-noise")?;
    let noises_deg = [0.15, 0.3, 0.45, 0.6, 0.8, 1.0].map(|noise| (noise, format!("{noise:?}")));
    let panel = |title: &'static str, kept: &str| -> Result<Panel, Box<dyn Error>> {
        let ticks = [0.2, 0.4, 0.6, 0.8, 1.0];
        let x = crate::axis("standard deviation of a bearing (°)", [0.1, 1.05], &ticks);
        let y = crate::percent("η, runs in which every track stays right (%)", 60.0, 10.0);
        let series = associators(&cells, &NAMES[..5], &noises_deg, kept)?;
        Ok(Panel {
            title,
            x,
            y,
            series,
        })
    };
    let panels = [
        panel("η by identity at the end", "identity")?,
        panel("η by staying all the time", "stay")?,
    ];
    draw(&out.join("wang-eta.svg"), &panels)
}

/// A curve for each associator.
fn associators(
    cells: &Cells,
    names: &[&str],
    along: &[(f64, String)],
    outcome: &str,
) -> Result<Vec<Series>, Box<dyn Error>> {
    let mut series = Vec::new();
    for (look, name) in names.iter().enumerate() {
        let of = along
            .iter()
            .map(|(x, point)| (*x, format!("{point}, {name}")));
        series.push(cells.series(name, (look, Drawn::Curve), (outcome, 100.0), of)?);
    }
    Ok(series)
}

/// In one order, so that each has the same look in all pictures.
const NAMES: [&str; 6] = [
    "NN, shared",
    "GNN",
    "BADA, sum",
    "JPDA",
    "NN, closest pair",
    "PDA",
];

/// Share of runs in which every track keeps its identity.
pub fn eta(folder: &Path, out: &Path) -> Result<(), Box<dyn Error>> {
    let clutter = [0.0, 0.1, 0.2, 0.4, 0.8];
    let targets = [2.0, 4.0, 6.0, 8.0, 10.0];
    let crossings = [0.0, 3.0, 7.0, 9.0];
    let panels = [
        eta_over(
            &Cells::of_campaign(folder, "wang-bat-clutter")?,
            "Six targets, over clutter",
            crate::axis("false detections per degree", [-0.03, 0.83], &clutter),
            &clutter.map(|number| (number, format!("{number:?}"))),
            0.0,
        )?,
        eta_over(
            &Cells::of_campaign(folder, "wang-bat-targets")?,
            "Over targets",
            crate::axis("targets", [1.6, 10.4], &targets),
            &targets.map(|number| (number, number.to_string())),
            70.0,
        )?,
        eta_over(
            &Cells::of_campaign(folder, "wang-bat-crossings")?,
            "Six targets, over crossings",
            crate::axis("crossings", [-0.4, 9.4], &crossings),
            &crossings.map(|number| (number, number.to_string())),
            70.0,
        )?,
    ];
    draw(&out.join("wang-eta-scenes.svg"), &panels)
}

fn eta_over(
    cells: &Cells,
    title: &'static str,
    x: Axis,
    along: &[(f64, String)],
    low: f64,
) -> Result<Panel, Box<dyn Error>> {
    Ok(Panel {
        title,
        x,
        y: crate::percent("runs that keep all targets (%)", low, 10.0),
        series: associators(cells, &NAMES, along, "identity")?,
    })
}

/// The job that a campaign runs.
fn scene(campaign: &str) -> Result<Value, Box<dyn Error>> {
    let mut preset = presets::find(campaign).ok_or("there is no such campaign")?;
    let mut base = preset.body["base"].take();
    base.as_object_mut()
        .ok_or("a job is an object")?
        .remove("kind");
    Ok(base)
}

fn evaluated(scene: &Value, associator: &Value) -> Result<Outcome, Box<dyn Error>> {
    let mut body = scene.clone();
    body["associator"] = associator.clone();
    done(JobKind::Evaluate, &body)
}

fn done(kind: JobKind, body: &Value) -> Result<Outcome, Box<dyn Error>> {
    let plan = plan(kind, body).map_err(|faults| format!("{faults:?}"))?;
    Ok(run(&plan, Vec::new(), &mut Silent)?)
}

fn is_kept(outcome: &Outcome) -> bool {
    outcome.result["metrics"]["track_keeping"]["quantities"]["identity"]["value"] == 1.0
}

fn file<'a>(outcome: &'a Outcome, name: &str) -> Result<&'a str, Box<dyn Error>> {
    let found = outcome.artifacts.iter().find(|file| file.name == name);
    let bytes = &found.ok_or_else(|| format!("there is no {name}"))?.bytes;
    Ok(std::str::from_utf8(bytes)?)
}

/// Time and bearing of the rows of a table that have this value in a column.
fn points(table: &str, column: &str, wanted: &str) -> Result<Vec<Point>, Box<dyn Error>> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let headers = reader.headers()?.clone();
    let place = |name: &str| {
        let found = headers.iter().position(|header| header == name);
        found.ok_or_else(|| format!("there is no column {name}"))
    };
    let (time, bearing, of) = (place("time_s")?, place("bearing_deg")?, place(column)?);
    let mut points = Vec::new();
    for row in reader.records() {
        let row = row?;
        if row[of] == *wanted {
            let y: f64 = row[bearing].parse()?;
            points.push(Point {
                x: row[time].parse()?,
                y,
                low: y,
                high: y,
            });
        }
    }
    points.dedup_by(|after, before| after.x == before.x);
    Ok(points)
}

/// One in `every` detections of each target, without clutter.
fn echoes(outcome: &Outcome, targets: usize, every: usize) -> Result<Vec<Series>, Box<dyn Error>> {
    let table = file(outcome, "detections.csv")?;
    let mut series = Vec::new();
    for look in 0..targets {
        let target = (look + 1).to_string();
        let points = points(table, "truth_id", &target)?;
        let name = match every {
            1 => format!("echo of target {target}"),
            _ => format!("target {target}, one echo in {every}"),
        };
        series.push(Series {
            points: points.into_iter().step_by(every).collect(),
            name,
            look,
            drawn: Drawn::Published,
        });
    }
    Ok(series)
}

/// A line for each target or track that is called by a number.
fn courses(
    outcome: &Outcome,
    table: &str,
    column: &str,
    what: &str,
    drawn: Drawn,
) -> Result<Vec<Series>, Box<dyn Error>> {
    let table = file(outcome, table)?;
    let mut series = Vec::new();
    for look in 0..6 {
        let name = (look + 1).to_string();
        let points = points(table, column, &name)?;
        if !points.is_empty() {
            series.push(Series {
                name: format!("{what} {name}"),
                look,
                drawn,
                points,
            });
        }
    }
    Ok(series)
}

fn time_axis() -> Axis {
    crate::axis(
        "time (s)",
        [0.0, 142.0],
        &[0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0],
    )
}

fn bearing_axis(low: f64, high: f64) -> Axis {
    let step = if high - low > 60.0 { 20.0 } else { 10.0 };
    let first = (low / step).ceil() as i32;
    let last = (high / step).floor() as i32;
    let ticks: Vec<f64> = (first..=last).map(|tick| f64::from(tick) * step).collect();
    crate::axis("bearing (°)", [low - 3.0, high + 3.0], &ticks)
}
