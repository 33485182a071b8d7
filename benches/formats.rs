//! `cargo bench -p trackloom-domain --bench formats`: what reading costs. Tables in MB a second, records of ASTERIX and frames of Mode S in
//! microseconds, sentences of AIS a second; each the best of several readings of a file that is made here. `-- asterix` reads only that.

use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;
use trackloom_domain::formats::asterix::encode::{PlotRecord, encode_plots};
use trackloom_domain::formats::feed::Motion;
use trackloom_domain::formats::{FormatOptions, ReadOptions, ReadOutcome, read_file};

const READINGS: u32 = 7;
const ROWS: u32 = 200_000;
const MESSAGES: u32 = 100_000;

fn main() {
    // `cargo test --benches` only wants to know that it starts.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    if std::env::args().any(|argument| argument == "asterix") {
        return read_plots();
    }
    let truth = truth();
    let took_s = best_s(truth.as_bytes());
    println!("CSV, truth:       {:>8.1} MB/s", mb(&truth) / took_s);
    let detections = detections();
    let took_s = best_s(detections.as_bytes());
    println!("CSV, detections:  {:>8.1} MB/s", mb(&detections) / took_s);
    read_plots();
    let took_s = best_s(sentences().as_bytes());
    println!(
        "AIS:              {:>8.0} sentences/s",
        f64::from(MESSAGES) / took_s
    );
    let took_s = best_s(frames().as_bytes());
    println!(
        "Mode S:           {:>8.2} µs a frame",
        took_s / f64::from(MESSAGES) * 1e6
    );
}

fn read_plots() {
    let took_s = best_s(&plots());
    println!(
        "ASTERIX, 048:     {:>8.2} µs a record",
        took_s / f64::from(MESSAGES) * 1e6
    );
}

fn mb(text: &str) -> f64 {
    text.len() as f64 / 1e6
}

/// The shortest time of a reading: what other programs do only ever adds.
fn best_s(bytes: &[u8]) -> f64 {
    let start = ("start".to_owned(), "2026-01-31T12:00:00Z".into());
    let options = ReadOptions {
        options: FormatOptions::from_iter([start]),
        ..ReadOptions::default()
    };
    let once = |_| {
        let begin = Instant::now();
        let read = read(bytes, &options);
        let took_s = begin.elapsed().as_secs_f64();
        assert!(read.units.used * 2 > read.units.total, "{:?}", read.units);
        black_box(&read);
        took_s
    };
    (0..READINGS).map(once).fold(f64::INFINITY, f64::min)
}

fn read(mut bytes: &[u8], options: &ReadOptions) -> ReadOutcome {
    match read_file("file", &mut bytes, None, options) {
        Ok((read, _)) => read,
        Err(faults) => panic!("{faults:?}"),
    }
}

/// A hundred targets that turn; every number has as many digits as a computer gives.
fn place(row: u32) -> [f64; 2] {
    let (target, step) = (f64::from(row % 100), f64::from(row / 100));
    let turned = target + step * 0.003;
    [turned.sin() * 1e4 + target, turned.cos() * 1e4 - target]
}

fn truth() -> String {
    let mut text = "time_s,truth_id,x_m,y_m,vx_mps,vy_mps\n".to_owned();
    for row in 0..ROWS {
        let ([x_m, y_m], time_s) = (place(row), row / 100);
        let (vx_mps, vy_mps) = (y_m * 0.003, x_m * -0.003);
        writeln!(
            text,
            "{time_s},target-{},{x_m},{y_m},{vx_mps},{vy_mps}",
            row % 100
        )
        .expect("a String takes any text");
    }
    text
}

fn detections() -> String {
    let mut text = "time_s,sensor_id,scan,detection_id,truth_id,amplitude,x_m,y_m\n".to_owned();
    for row in 0..ROWS {
        let ([x_m, y_m], scan) = (place(row), row / 100);
        writeln!(
            text,
            "{scan},radar,{},d{row},target-{},12.5,{x_m},{y_m}",
            scan + 1,
            row % 100
        )
        .expect("a String takes any text");
    }
    text
}

fn plots() -> Vec<u8> {
    let plot = |row: u32| PlotRecord {
        source: (25, 201),
        time_s: 30_000.0 + f64::from(row) / 128.0,
        place: Some((
            20_000.0 + f64::from(row % 5000) * 40.0,
            f64::from(row % 628) / 100.0,
        )),
        detection: 5,
        is_simulated: false,
        is_test: false,
        is_tentative: false,
        ends: false,
        mode_a: Some((row % 4096) as u16),
        level_ft: Some(33_000.0),
        address: Some(0x3c_0000 + row % 1000),
        callsign: Some(format!("DLH{}", row % 1000)),
        number: Some((row % 1000) as u16),
        motion: Some(Motion {
            speed_mps: 220.0,
            course_rad: 1.0,
        }),
    };
    let plots: Vec<PlotRecord> = (0..MESSAGES).map(plot).collect();
    encode_plots(&plots)
}

/// Position reports of class A by 500 ships, twenty a second.
fn sentences() -> String {
    let mut text = String::new();
    for row in 0..MESSAGES {
        let (ship, time_s) = (row % 500, 1_769_860_800 + u64::from(row / 20));
        let mut bits = [0_u8; 28];
        let lon = 6_000_000 + u64::from(ship * 1000 + row / 500);
        let fields = [
            (0, 6, 1),
            (8, 30, u64::from(200_000_000 + ship)),
            (50, 10, 100),
            (61, 28, lon),
            (89, 27, 30_000_000),
            (116, 12, 900),
            (128, 9, 90),
            (137, 6, time_s % 60),
        ];
        for (from, count, value) in fields {
            put(&mut bits, 6, (from, count), value);
        }
        let armoured = bits.map(|six| char::from(six + if six < 40 { 48 } else { 56 }));
        let body = format!("AIVDM,1,1,,A,{},0", String::from_iter(armoured));
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        writeln!(text, "!{body}*{sum:02X},r1,{time_s}").expect("a String takes any text");
    }
    text
}

/// Writes a number into bits, counted from the first, of units of `width` bits.
fn put(units: &mut [u8], width: usize, (from, count): (usize, usize), value: u64) {
    for bit in (0..count).filter(|bit| value >> (count - 1 - bit) & 1 == 1) {
        let at = from + bit;
        units[at / width] |= 1 << (width - 1 - at % width);
    }
}

/// Positions in the air of 100 aircraft, even and odd in turns: each flies to and fro between two places 1.6 km apart, 5 s a way.
fn frames() -> String {
    // J. Sun, The 1090 Megahertz Riddle: the bits of a pair at 52.2572 N 3.91937 E.
    const PAIR: [[u8; 7]; 2] = [
        [0x58, 0xc3, 0x82, 0xd6, 0x90, 0xc8, 0xac],
        [0x58, 0xc3, 0x86, 0x43, 0x5c, 0xc4, 0x12],
    ];
    let mut text = String::new();
    for row in 0..MESSAGES {
        let address = 0x40_6200 + row % 100;
        let mut frame = vec![0x8d];
        frame.extend_from_slice(&address.to_be_bytes()[1..]);
        frame.extend_from_slice(&PAIR[(row / 100 % 2) as usize]);
        frame.extend_from_slice(&parity(&frame).to_be_bytes()[1..]);
        let seconds = 1_698_142_148.0 + f64::from(row) * 0.05;
        write!(text, "{seconds:.6},1a3300000000000100").expect("a String takes any text");
        for octet in frame {
            write!(text, "{octet:02x}").expect("a String takes any text");
        }
        text.push('\n');
    }
    text
}

/// What is left of the frame by the generator 1FFF409, bit by bit.
fn parity(frame: &[u8]) -> u32 {
    let mut rest: u32 = 0;
    for octet in frame.iter().copied().chain([0; 3]) {
        for bit in (0..8).rev() {
            rest = rest << 1 | u32::from(octet >> bit & 1);
            rest ^= if rest >> 24 == 1 { 0x1ff_f409 } else { 0 };
        }
    }
    rest
}
