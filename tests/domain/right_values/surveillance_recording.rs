//! A recording of 200 flights with planted faults: each of them is found, and nothing else.

use super::judged;
use serde_json::json;
use std::fmt::Write;

const FLIGHTS: usize = 200;
const STEP_S: u32 = 4;
const LENGTH_S: u32 = 600;
const LANE_M: f64 = 5000.0;

/// A generator of numbers (Park and Miller, Random number generators, Communications of the ACM 31, 1988).
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: u32) -> u32 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        (self.0 % u64::from(count)) as u32
    }
}

#[derive(Clone)]
struct Row {
    time_s: u32,
    track: String,
    x_m: f64,
    y_m: f64,
    address: String,
    mode_a: String,
    mode_c_ft: i32,
}

/// What is in the recording of one flight, and what is planted.
struct Scene {
    dice: Dice,
    truth: String,
    /// Of each flight.
    rows: Vec<Vec<Row>>,
    others: Vec<Row>,
    planted: Vec<String>,
}

fn name(flight: usize) -> String {
    format!("F{flight}")
}

fn track(flight: usize) -> String {
    format!("T{flight}")
}

impl Scene {
    fn new(seed: u64) -> Scene {
        let mut scene = Scene {
            dice: Dice(seed),
            truth: "time_s,truth_id,x_m,y_m,address,mode_a,mode_c_ft\n".to_owned(),
            rows: Vec::new(),
            others: Vec::new(),
            planted: Vec::new(),
        };
        for flight in 0..FLIGHTS {
            scene.add_flight(flight);
        }
        scene
    }

    /// On a lane of its own; two that follow each other begin at one time.
    fn add_flight(&mut self, flight: usize) {
        let from_s = match self.rows.last() {
            Some(before) if flight % 2 == 1 => before[0].time_s,
            _ => self.dice.below(400),
        };
        let (start_m, y_m) = (f64::from(self.dice.below(50_000)), LANE_M * flight as f64);
        let mut rows = Vec::new();
        for time_s in (from_s..=from_s + LENGTH_S).step_by(STEP_S as usize) {
            let x_m = start_m + 200.0 * f64::from(time_s - from_s);
            let row = Row {
                time_s,
                track: track(flight),
                x_m: x_m + f64::from(self.dice.below(41)) - 20.0,
                y_m: y_m + f64::from(self.dice.below(41)) - 20.0,
                address: format!("{:06X}", 0x3C_0000 + flight),
                mode_a: format!("{:04o}", 0o1000 + flight),
                mode_c_ft: 20_000 + 10 * flight as i32,
            };
            let Row {
                address,
                mode_a,
                mode_c_ft,
                ..
            } = &row;
            let id = name(flight);
            writeln!(
                self.truth,
                "{time_s},{id},{x_m},{y_m},{address},{mode_a},{mode_c_ft}"
            )
            .unwrap();
            rows.push(row);
        }
        self.rows.push(rows);
    }

    /// An update that is not near an end.
    fn somewhere(&mut self) -> usize {
        40 + self.dice.below(60) as usize
    }

    fn plant(&mut self, time_s: u32, truth: &str, track: &str, fault: &str) {
        self.planted
            .push(format!("{time_s},{truth},{track},{fault}"));
    }

    fn plant_in(&mut self, flight: usize, index: usize, fault: &str) {
        let row = self.rows[flight][index].clone();
        self.plant(row.time_s, &name(flight), &row.track, fault);
    }

    /// Plants a fault of a kind in a flight; swaps take the next one, too.
    fn spoil(&mut self, kind: usize, flight: usize) {
        let index = self.somewhere();
        match kind {
            0 => {
                let lost = 2 + self.dice.below(5) as usize;
                let from_s = self.rows[flight][index - 1].time_s;
                self.rows[flight].drain(index..index + lost);
                let gap_s = (lost as u32 + 1) * STEP_S;
                self.plant(from_s, &name(flight), "", &format!("detection,gap,{gap_s}"));
            }
            1 => {
                for (one, other) in [(flight, flight + 1), (flight + 1, flight)] {
                    for row in &mut self.rows[one][index..] {
                        row.track = track(other);
                    }
                    self.plant_in(one, index, "continuity,swap,");
                }
            }
            2 => {
                self.rows[flight][index].mode_a = "7777".to_owned();
                self.plant_in(flight, index, "mode_a_false,mode_a_false,");
            }
            3 => {
                // Another flight's, far away.
                self.rows[flight][index].address =
                    format!("{:06X}", 0x3C_0000 + (flight + 100) % 200);
                self.plant_in(flight, index, "address_false,identity_false,");
            }
            4 => {
                self.rows[flight][index].mode_c_ft += 900;
                self.plant_in(flight, index, "mode_c_false,mode_c_false,900");
            }
            5 => {
                self.rows[flight][index].y_m = LANE_M * flight as f64 + 2500.0;
                self.rows[flight][index].x_m += 1000.0;
                self.plant_in(flight, index, "position_beyond,position_beyond,far");
            }
            6 => {
                for row in &mut self.rows[flight][index..] {
                    row.track = format!("N{flight}");
                }
                self.plant_in(flight, index, "continuity,new_number,");
            }
            7 => self.double(flight, index),
            8 => self.fly_on(flight),
            9 => self.begin_late(flight),
            _ => self.invent(flight),
        }
    }

    /// A second number on the flight for 100 s.
    fn double(&mut self, flight: usize, index: usize) {
        for place in index..index + 26 {
            let mut row = self.rows[flight][place].clone();
            self.plant_in(flight, place, "extra_track,extra_track,");
            row.track = format!("D{flight}");
            let double = row.track.clone();
            self.plant(
                row.time_s,
                &name(flight),
                &double,
                "extra_track,extra_track,",
            );
            self.others.push(row);
        }
    }

    /// The track goes on for 40 s behind the end of the flight.
    fn fly_on(&mut self, flight: usize) {
        let last = self.rows[flight].last().unwrap().clone();
        for step in 1..=10 {
            let mut row = last.clone();
            row.time_s += step * STEP_S;
            row.x_m += 800.0 * f64::from(step);
            let fault = "extra_data,extra_data,";
            self.plant(row.time_s, &name(flight), &row.track, fault);
            self.others.push(row);
        }
    }

    /// The first 40 s are missing.
    fn begin_late(&mut self, flight: usize) {
        let from_s = self.rows[flight][0].time_s;
        self.rows[flight].drain(..10);
        self.plant(from_s, &name(flight), "", "detection,gap,40");
        let fault = "initiation_delay,late,40";
        self.plant(from_s, &name(flight), &track(flight), fault);
    }

    /// A track of nobody, far behind all lanes.
    fn invent(&mut self, flight: usize) {
        let mut rows: Vec<Row> = self.rows[flight][20..60].to_vec();
        for row in &mut rows {
            row.track = format!("G{flight}");
            (row.y_m, row.address, row.mode_a) =
                (-200_000.0, "0000FF".to_owned(), "0777".to_owned());
        }
        let first = rows[0].clone();
        self.plant(first.time_s, "", &first.track, "false_tracks,false_track,");
        self.others.extend(rows);
    }

    fn tracks(&self) -> String {
        let mut text = "time_s,track_id,x_m,y_m,address,mode_a,mode_c_ft\n".to_owned();
        let mut rows: Vec<&Row> = self.rows.iter().flatten().chain(&self.others).collect();
        rows.sort_by_key(|row| row.time_s);
        for row in rows {
            let Row {
                time_s,
                track,
                x_m,
                y_m,
                address,
                mode_a,
                mode_c_ft,
            } = row;
            writeln!(
                text,
                "{time_s},{track},{x_m},{y_m},{address},{mode_a},{mode_c_ft}"
            )
            .unwrap();
        }
        text
    }
}

#[test]
fn every_planted_fault_is_found_and_no_other() {
    for (seed, pairing) in [(20_251, "auto"), (7, "auto"), (31, "nearest")] {
        let mut scene = Scene::new(seed);
        // Every fourth flight is spoilt, by turns in eleven ways.
        for (turn, flight) in (0..FLIGHTS).step_by(4).enumerate() {
            scene.spoil(turn % 11, flight);
        }
        let requirements = json!({
            "gate_m": 1000.0, "pairing": pairing,
            "items": [
                {"requirement": "detection", "update_interval_s": 4.0, "tolerance_s": 0.5},
                {"requirement": "continuity"},
                {"requirement": "mode_a_false"},
                {"requirement": "identity_false", "name": "address_false", "of": ["address"]},
                {"requirement": "mode_c_false"},
                {"requirement": "position_beyond", "distance_m": 500.0},
                {"requirement": "extra_track"},
                {"requirement": "extra_data"},
                {"requirement": "initiation_delay", "max_delay_s": 8.0},
                {"requirement": "false_tracks"}
            ]
        });
        let settings = json!({"profile": "vision", "metrics": [], "requirements": requirements});
        let outcome = judged(&scene.truth, &scene.tracks(), settings);
        let file = outcome
            .artifacts
            .iter()
            .find(|artifact| artifact.name == "requirement_events.csv")
            .unwrap();
        let text = String::from_utf8(file.bytes.clone()).unwrap();
        let mut found: Vec<String> = text.lines().skip(1).map(event).collect();
        found.sort();
        scene.planted.sort();
        assert!(scene.planted.len() > 100);
        assert_eq!(found, scene.planted, "seed {seed}");
    }
}

/// Time, target, track, requirement, fault and size of a row of the file; how far an outlier is has noise.
fn event(row: &str) -> String {
    let cells: Vec<&str> = row.split(',').collect();
    let size = match cells[5] {
        "position_beyond" => {
            let size_m: f64 = cells[6].parse().unwrap();
            assert!((size_m - 1000f64.hypot(2500.0)).abs() < 40.0, "{row}");
            "far"
        }
        _ => cells[6],
    };
    [cells[0], cells[1], cells[2], cells[4], cells[5], size].join(",")
}
