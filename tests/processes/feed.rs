//! `trackloom feed`: what a file, the standard input, UDP and TCP bring is in the session as it is in the dataset of the file; a feed
//! or a server that is killed in the middle loses nothing and says nothing twice.

use crate::process::{Process, Server, signal, trackloom};
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use trackloom::formats::asterix::encode::{MarkRecord, PlotRecord, encode_marks, encode_plots};

/// What is fed, and how it is read.
struct Sample {
    bytes: Vec<u8>,
    name: &'static str,
    /// As the file calls its sensor.
    sensor_id: &'static str,
    /// Of the session's sensor.
    noise: Value,
    /// What `meta` of an upload and `--option` say.
    options: Vec<(&'static str, Value)>,
    /// Whether it is lines.
    is_text: bool,
}

const PLACES: &str = r#"{"sigma_x_m": 50.0, "sigma_y_m": 50.0}"#;
const POLAR: &str = r#"{"sigma_range_m": 70.0, "sigma_bearing_deg": 0.1, "x_m": 0.0, "y_m": 0.0}"#;

fn noise(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// Two hundred scans of a radar, numbered, with empty ones among them.
fn table() -> Sample {
    let mut text = String::from("time_s,scan,sensor_id,detection_id,x_m,y_m\n");
    for scan in 0..200_u32 {
        let time_s = 1000.0 + 0.02 * f64::from(scan);
        if scan % 17 == 5 {
            text.push_str(&format!("{time_s},{scan},radar,,,\n"));
            continue;
        }
        for target in 0..4_u32 {
            let x_m = 10.0 * f64::from(scan) / 3.0 + 700.0 * f64::from(target);
            let id = scan * 4 + target;
            text.push_str(&format!(
                "{time_s},{scan},radar,d{id},{x_m},{}\n",
                x_m / 7.0
            ));
        }
    }
    Sample {
        bytes: text.into_bytes(),
        name: "radar.csv",
        sensor_id: "radar",
        noise: noise(PLACES),
        options: Vec::new(),
        is_text: true,
    }
}

/// The same as records, one a line.
fn records() -> Sample {
    let table = table();
    let text = String::from_utf8(table.bytes).unwrap();
    let mut lines = String::new();
    for row in text.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        if cells[4].is_empty() {
            continue;
        }
        let number = |at: usize| cells[at].parse::<f64>().unwrap();
        let record =
            json!({"time_s": number(0), "sensor_id": "radar", "x_m": number(4), "y_m": number(5)});
        lines.push_str(&format!("{record}\n"));
    }
    Sample {
        bytes: lines.into_bytes(),
        name: "radar.json",
        ..table
    }
}

/// Fills bits of a message, the first one first.
fn put(bits: &mut Vec<u8>, value: i64, count: u32) {
    bits.extend((0..count).rev().map(|bit| (value >> bit & 1) as u8));
}

/// A position report of class A in the armour of NMEA.
fn position_report(mmsi: i64, lat_deg: f64, lon_deg: f64, second: i64) -> String {
    let mut bits = Vec::new();
    for (value, count) in [
        (1, 6),
        (0, 2),
        (mmsi, 30),
        (0, 4),
        (-128, 8),
        (123, 10),
        (1, 1),
    ] {
        put(&mut bits, value, count);
    }
    put(&mut bits, (lon_deg * 600_000.0).round() as i64, 28);
    put(&mut bits, (lat_deg * 600_000.0).round() as i64, 27);
    for (value, count) in [
        (900, 12),
        (511, 9),
        (second, 6),
        (0, 2),
        (0, 3),
        (0, 1),
        (0, 19),
    ] {
        put(&mut bits, value, count);
    }
    let letter = |six: &[u8]| {
        let value = six.iter().fold(0, |value, bit| value << 1 | bit);
        char::from(if value < 40 { value + 48 } else { value + 56 })
    };
    bits.chunks(6).map(letter).collect()
}

fn checked(text: &str) -> String {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{text}*{sum:02X}")
}

/// Ships with tag blocks; every fourth report comes in two sentences, with the next one's between them.
fn ais() -> Sample {
    let mut lines = Vec::new();
    for step in 0..60_i64 {
        for ship in 0..6_i64 {
            let time_s = 1_700_000_000 + step;
            let lat_deg = 50.7 + 0.0001 * step as f64 + 0.01 * ship as f64;
            let report = position_report(235_000_000 + ship, lat_deg, -1.2, time_s % 60);
            let tag = checked(&format!("c:{time_s}"));
            let count = step * 6 + ship;
            if count % 4 == 3 {
                let (first, second) = report.split_at(14);
                let channel = count % 10;
                lines.push(format!(
                    "\\{tag}\\!{}",
                    checked(&format!("AIVDM,2,1,{channel},A,{first},0"))
                ));
                let rest = format!(
                    "\\{tag}\\!{}",
                    checked(&format!("AIVDM,2,2,{channel},A,{second},0"))
                );
                lines.push(rest);
            } else {
                lines.push(format!(
                    "\\{tag}\\!{}",
                    checked(&format!("AIVDM,1,1,,A,{report},0"))
                ));
            }
        }
        lines.push(String::from("# a comment"));
        lines.push(String::from(
            "!AIVDM,1,1,,A,15RTgt0PAso;90TKcjM8h6g208CQ,0*4B",
        ));
    }
    Sample {
        bytes: (lines.join("\n") + "\n").into_bytes(),
        name: "harbour.nmea",
        sensor_id: "ais",
        noise: noise(PLACES),
        options: vec![("frame_s", json!(5.0)), ("max_rejected", json!(0.5))],
        is_text: true,
    }
}

/// Lines of a BaseStation.
fn base_station() -> Sample {
    let mut text = String::new();
    for step in 0..120_u32 {
        for aircraft in 0..3_u32 {
            let time = format!(
                "23:{:02}:{:02}.{}00",
                59 - (119 - step) / 60,
                step % 60,
                aircraft
            );
            let lat_deg = 51.0 + 0.002 * f64::from(step) + f64::from(aircraft) * 0.3;
            text.push_str(&format!(
                "MSG,3,1,1,4CA{aircraft:03X},1,2024/03/01,{time},2024/03/01,{time},,3500,,,{lat_deg:.5},-0.50000,,,0,0,0,0\n"
            ));
            text.push_str(&format!("MSG,4,1,1,4CA{aircraft:03X},1,2024/03/01,{time},2024/03/01,{time},,,420.0,90.0,,,0,,,,,0\n"));
        }
    }
    Sample {
        bytes: text.into_bytes(),
        name: "port30003.sbs",
        sensor_id: "adsb",
        noise: noise(PLACES),
        options: vec![("utc_offset_s", json!(3600.0))],
        is_text: true,
    }
}

/// Plots of a radar across midnight, with its north marks.
fn asterix() -> Sample {
    let source = (25, 1);
    let mut bytes = Vec::new();
    for turn in 0..30 {
        let north_s = (86_340.0 + 4.0 * f64::from(turn)) % 86_400.0;
        bytes.extend(encode_marks(&[MarkRecord {
            source,
            time_s: north_s,
            kind: 1,
            sector: None,
            rotation_s: Some(4.0),
            site: None,
        }]));
        let mut plots = Vec::new();
        for target in 0..5_u32 {
            let bearing_rad = 0.4 + f64::from(target);
            plots.push(PlotRecord {
                source,
                time_s: (north_s + 4.0 * bearing_rad / std::f64::consts::TAU) % 86_400.0,
                place: Some((20_000.0 + 100.0 * f64::from(turn), bearing_rad)),
                detection: 1,
                is_simulated: false,
                is_test: false,
                is_tentative: false,
                ends: false,
                mode_a: None,
                level_ft: Some(10_000.0),
                address: None,
                callsign: None,
                number: None,
                motion: None,
            });
        }
        bytes.extend(encode_plots(&plots));
    }
    Sample {
        bytes,
        name: "radar.ast",
        sensor_id: "25/1",
        noise: noise(POLAR),
        options: vec![
            ("date", json!("2024-02-29")),
            (
                "sites",
                json!([{"sensor_id": "25/1", "lat_deg": 51.0, "lon_deg": -1.0, "height_m": 100.0}]),
            ),
        ],
        is_text: false,
    }
}

/// A recording of others; `None`, with the reason, where it is not at hand.
fn recorded(path: &str) -> Option<Vec<u8>> {
    let folder = std::env::var_os("TRACKLOOM_DATA").map(PathBuf::from);
    let read = folder.and_then(|folder| std::fs::read(folder.join(path)).ok());
    if read.is_none() {
        println!("skipped: {path} is not in TRACKLOOM_DATA");
    }
    read
}

const ORIGIN: (f64, f64) = (51.0, -1.0);

impl Sample {
    fn session(&self) -> Value {
        let mut sensor = self.noise.clone();
        sensor["sensor_id"] = json!("own");
        sensor["p_d"] = json!(0.9);
        sensor["clutter_per_m2"] = json!(1e-10);
        json!({
            "sensors": [sensor], "origin": {"lat_deg": ORIGIN.0, "lon_deg": ORIGIN.1}, "max_gap_s": 1e9,
            "tracker": {"initial_speed_sigma_mps": 100.0}
        })
    }

    /// The feed of a source into a session that it makes.
    fn command(&self, server: &Server, folder: &Path, source: &str) -> Command {
        std::fs::write(folder.join("session.json"), self.session().to_string()).unwrap();
        let mut command = self.feed(server, source);
        command.arg("--create").arg(folder.join("session.json"));
        command
    }

    fn feed(&self, server: &Server, source: &str) -> Command {
        let mut command = trackloom();
        command.args(["feed", "--server", &server.url, source, "--settle-s", "120"]);
        if !self.sensor_id.is_empty() {
            command.args(["--sensor", &format!("{}=own", self.sensor_id)]);
        }
        for (name, value) in &self.options {
            command.args(["--option", &format!("{name}={value}")]);
        }
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn file(&self, folder: &Path) -> String {
        let path = folder.join(self.name);
        std::fs::write(&path, &self.bytes).unwrap();
        path.to_str().unwrap().to_owned()
    }

    /// What the dataset of the file has.
    async fn uploaded(&self, server: &Server) -> Rows {
        let mut meta =
            json!({"kind": "detections", "origin": {"lat_deg": ORIGIN.0, "lon_deg": ORIGIN.1}});
        for (name, value) in &self.options {
            meta[name] = value.clone();
        }
        let file = Part::bytes(self.bytes.clone()).file_name(self.name);
        let form = Form::new()
            .part("meta", Part::text(meta.to_string()))
            .part("file", file);
        let asked = server.client.post(format!("{}/v1/datasets", server.url));
        let answer = asked.multipart(form).send().await.unwrap();
        let (status, answer) = (answer.status(), answer.json::<Value>().await.unwrap());
        assert!(status.is_success(), "{answer}");
        rows(server, answer["id"].as_str().unwrap()).await
    }
}

/// Detections by their identities, with all that was measured, and how many scans there are.
#[derive(Debug, PartialEq)]
struct Rows {
    scans: u64,
    detections: Vec<(String, Vec<Option<f64>>)>,
}

impl Rows {
    /// What was measured alone: units after a broken one have other numbers.
    fn measured(&self) -> (u64, Vec<Vec<Option<f64>>>) {
        let values = self.detections.iter().map(|(_, values)| values.clone());
        let mut values: Vec<Vec<Option<f64>>> = values.collect();
        values.sort_by(|one, other| one.partial_cmp(other).unwrap());
        (self.scans, values)
    }
}

async fn rows(server: &Server, dataset: &str) -> Rows {
    let info = server.get(&format!("/v1/datasets/{dataset}")).await;
    let url = format!("{}/v1/datasets/{dataset}/content?format=csv", server.url);
    let text = server
        .client
        .get(url)
        .send()
        .await
        .unwrap()
        .text()
        .await
        .unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut detections = Vec::new();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |name: &str| {
            let at = names.iter().position(|known| *known == name)?;
            Some(cells[at]).filter(|cell| !cell.is_empty())
        };
        let measured = ["x_m", "y_m", "range_m", "bearing_deg"];
        let values: Vec<Option<f64>> = measured
            .iter()
            .map(|name| cell(name).map(|cell| cell.parse().unwrap()))
            .collect();
        if values.iter().any(Option::is_some) {
            detections.push((cell("detection_id").unwrap().to_owned(), values));
        }
    }
    detections.sort_by(|one, other| one.partial_cmp(other).unwrap());
    let scans = info["scans"].as_u64().unwrap();
    Rows { scans, detections }
}

/// What a session took, as the dataset that it becomes.
async fn closed(server: &Server, id: &str) -> Rows {
    let asked = server
        .client
        .post(format!("{}/v1/sessions/{id}/close", server.url));
    let answer = asked.send().await.unwrap();
    assert_eq!(answer.status(), 200);
    let info: Value = answer.json().await.unwrap();
    rows(server, info["dataset_id"].as_str().unwrap()).await
}

fn id_of(output: &Output) -> String {
    String::from_utf8(output.stdout.clone())
        .unwrap()
        .trim()
        .to_owned()
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[track_caller]
fn done(output: Output) -> Output {
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    output
}

fn from_stdin(mut command: Command, bytes: &[u8], size: usize) -> Output {
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    for part in bytes.chunks(size) {
        input.write_all(part).unwrap();
    }
    drop(input);
    done(child.wait_with_output().unwrap())
}

/// What a feed says that is refused, be it before it has read its standard input.
#[track_caller]
fn refused(mut command: Command, bytes: &[u8]) -> String {
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    let _ = child.stdin.take().unwrap().write_all(bytes);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    said(&output)
}

/// The first line that a feed says on its standard error, and the rest of it.
fn first_said(child: &mut Child) -> (String, BufReader<std::process::ChildStderr>) {
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    errors.read_line(&mut line).unwrap();
    (line, errors)
}

/// Ends a feed by Ctrl-C when it has read what was sent; gives the identity of its session.
fn interrupted(child: Child, errors: &mut dyn Read) -> String {
    std::thread::sleep(Duration::from_millis(1500));
    signal(child.id(), "INT");
    let output = child.wait_with_output().unwrap();
    let mut told = String::new();
    errors.read_to_string(&mut told).unwrap();
    assert_eq!(output.status.code(), Some(0), "{told}");
    id_of(&output)
}

/// Units as datagrams: lines by tens, blocks one by one.
fn datagrams(sample: &Sample) -> Vec<Vec<u8>> {
    if sample.is_text {
        let lines: Vec<&[u8]> = sample
            .bytes
            .split_inclusive(|byte| *byte == b'\n')
            .collect();
        return lines.chunks(10).map(<[&[u8]]>::concat).collect();
    }
    let (mut rest, mut blocks) = (sample.bytes.as_slice(), Vec::new());
    while !rest.is_empty() {
        let length = usize::from(u16::from_be_bytes([rest[1], rest[2]]));
        let (block, others) = rest.split_at(length);
        blocks.push(block.to_vec());
        rest = others;
    }
    blocks
}

fn over_udp(mut command: Command, sample: &Sample) -> String {
    let mut child = command.spawn().unwrap();
    let (line, mut errors) = first_said(&mut child);
    let address = line
        .trim()
        .strip_prefix("listening on udp://")
        .unwrap()
        .to_owned();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    for datagram in datagrams(sample) {
        socket.send_to(&datagram, &address).unwrap();
        std::thread::sleep(Duration::from_millis(1));
    }
    interrupted(child, &mut errors)
}

/// The connection ends in the middle of a unit, which is sent again with the rest over the next.
fn over_tcp(sample: &Sample, listener: &TcpListener, mut command: Command) -> String {
    let mut child = command.spawn().unwrap();
    let sent = datagrams(sample);
    let (first, second) = sent.split_at(sent.len() / 2);
    let (mut connection, _) = listener.accept().unwrap();
    for part in first.concat().chunks(333) {
        connection.write_all(part).unwrap();
    }
    connection.write_all(&second[0][..7]).unwrap();
    drop(connection);
    let (mut connection, _) = listener.accept().unwrap();
    for part in second.concat().chunks(97) {
        connection.write_all(part).unwrap();
    }
    let mut errors = child.stderr.take().unwrap();
    interrupted(child, &mut errors)
}

/// Feeds a sample every way, and gives what its dataset has.
async fn every_way(server: &Server, sample: &Sample) -> Rows {
    let folder = tempfile::tempdir().unwrap();
    let wanted = sample.uploaded(server).await;
    let file = sample.file(folder.path());
    let mut command = sample.command(server, folder.path(), &file);
    let output = done(command.args(["--speed", "max"]).output().unwrap());
    assert_eq!(
        closed(server, &id_of(&output)).await,
        wanted,
        "{} as a file",
        sample.name
    );
    for size in [7, 4096] {
        let command = sample.command(server, folder.path(), "-");
        let output = from_stdin(command, &sample.bytes, size);
        assert_eq!(
            closed(server, &id_of(&output)).await,
            wanted,
            "{} from stdin",
            sample.name
        );
    }
    let command = sample.command(server, folder.path(), "udp://127.0.0.1:0");
    let id = over_udp(command, sample);
    assert_eq!(
        closed(server, &id).await,
        wanted,
        "{} over UDP",
        sample.name
    );
    wanted
}

#[tokio::test(flavor = "multi_thread")]
async fn a_table_is_in_the_session_as_in_its_dataset_whatever_way_it_comes() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let found = every_way(&server, &table()).await;
    // Twelve of 200 scans are empty.
    assert_eq!((found.scans, found.detections.len()), (200, 752));
    let last = found
        .detections
        .iter()
        .find(|(id, _)| id == "d799")
        .unwrap();
    let x_m = 10.0 * 199.0 / 3.0 + 2100.0;
    assert_eq!(last.1[..2], [Some(x_m), Some(x_m / 7.0)]);
    let found = every_way(&server, &records()).await;
    assert_eq!((found.scans, found.detections.len()), (188, 752));
}

#[tokio::test(flavor = "multi_thread")]
async fn ships_and_aircraft_are_in_the_session_as_in_their_datasets() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let found = every_way(&server, &ais()).await;
    // A frame of 5 s has the last report of each of six ships.
    assert_eq!((found.scans, found.detections.len()), (12, 72));
    let found = every_way(&server, &base_station()).await;
    assert_eq!((found.scans, found.detections.len()), (12, 36));
}

#[tokio::test(flavor = "multi_thread")]
async fn plots_across_midnight_are_in_the_session_as_in_their_dataset() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    let found = every_way(&server, &asterix()).await;
    assert_eq!((found.scans, found.detections.len()), (30, 150));
    assert!(
        found
            .detections
            .iter()
            .all(|(_, values)| values[2].is_some_and(|range_m| range_m > 19_000.0))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn connections_that_end_are_made_again() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    for sample in [table(), asterix()] {
        let folder = tempfile::tempdir().unwrap();
        let wanted = sample.uploaded(&server).await;
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let source = format!("tcp://{}", listener.local_addr().unwrap());
        let command = sample.command(&server, folder.path(), &source);
        let id = over_tcp(&sample, &listener, command);
        assert_eq!(
            closed(&server, &id).await.measured(),
            wanted.measured(),
            "{} over TCP",
            sample.name
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn recordings_of_others_are_in_the_session_as_in_their_datasets() {
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &[]);
    if let Some(bytes) = recorded("ais-nmea/libais_tagblock.nmea") {
        let sample = Sample { bytes, ..ais() };
        assert_eq!(every_way(&server, &sample).await.detections.len(), 3);
    }
    if let Some(bytes) = recorded("asterix-samples/cat21_re.ast") {
        let sample = Sample {
            bytes,
            sensor_id: "0/0",
            noise: noise(PLACES),
            options: vec![("date", json!("2024-02-29"))],
            ..asterix()
        };
        let sample = Sample {
            sensor_id: Box::leak(only_sensor(&sample, &server).await.into_boxed_str()),
            ..sample
        };
        assert_eq!(every_way(&server, &sample).await.detections.len(), 2);
    }
}

/// The sensor that a dataset of the sample has.
async fn only_sensor(sample: &Sample, server: &Server) -> String {
    sample.uploaded(server).await;
    let listed = server.get("/v1/datasets?limit=1").await;
    let id = listed["items"][0]["id"].as_str().unwrap().to_owned();
    let info = server.get(&format!("/v1/datasets/{id}")).await;
    info["sensor_ids"][0].as_str().unwrap().to_owned()
}

/// Waits until a session that a feed has made has so many scans.
async fn until_scans(server: &Server, scans: u64) -> String {
    let since = Instant::now();
    loop {
        let listed = server.get("/v1/sessions?limit=1").await;
        if let Some(id) = listed["items"][0]["id"].as_str() {
            let info = server.get(&format!("/v1/sessions/{id}")).await;
            if info["live"]["counts"]["scans"].as_u64().unwrap() >= scans {
                return id.to_owned();
            }
        }
        assert!(
            since.elapsed() < Duration::from_secs(60),
            "{scans} scans never came"
        );
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_feed_that_is_killed_goes_on_where_the_session_is() {
    let (data, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &[]);
    let sample = table();
    let wanted = sample.uploaded(&server).await;
    let file = sample.file(folder.path());
    let mut command = sample.command(&server, folder.path(), &file);
    let mut child = command.args(["--speed", "1"]).spawn().unwrap();
    let id = until_scans(&server, 40).await;
    child.kill().unwrap();
    child.wait().unwrap();
    // What was on its way is taken.
    tokio::time::sleep(Duration::from_millis(500)).await;
    let had = server.get(&format!("/v1/sessions/{id}")).await["live"].clone();
    let had_scans = had["counts"]["scans"].as_u64().unwrap();
    assert!((40..200).contains(&had_scans), "{had}");
    assert_eq!(had["sensors"][0]["last_sequence"], had_scans);
    let mut command = sample.feed(&server, &file);
    let again = done(
        command
            .args(["--session", &id, "--speed", "max"])
            .output()
            .unwrap(),
    );
    let left = 200 - had_scans;
    assert!(
        said(&again).starts_with(&format!("{left} scans, ")),
        "{}",
        said(&again)
    );
    let info = server.get(&format!("/v1/sessions/{id}")).await;
    assert_eq!(info["live"]["counts"]["missing"], 0);
    assert_eq!(info["entries"], 200, "nothing twice");
    assert_eq!(closed(&server, &id).await, wanted);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_feed_outlives_its_server() {
    let (data, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let mut server = Server::start(data.path(), &[]);
    let address = server.url.strip_prefix("http://").unwrap().to_owned();
    let sample = table();
    let wanted = sample.uploaded(&server).await;
    let file = sample.file(folder.path());
    let mut command = sample.command(&server, folder.path(), &file);
    let child = command.args(["--speed", "0.7"]).spawn().unwrap();
    let since = Instant::now();
    for scans in [20, 70, 120] {
        let id = until_scans(&server, scans).await;
        assert!(!id.is_empty());
        server.kill();
        tokio::time::sleep(Duration::from_millis(300)).await;
        let mut command = trackloom();
        command.args(["serve", "--workers", "2", "--listen", &address, "--data"]);
        server = Server::of(Process::start(command.arg(data.path())));
    }
    let output = done(child.wait_with_output().unwrap());
    // 3.98 s of the recording at 0.7 times its pace, of which a little was over when its scans were looked for.
    let took_s = since.elapsed().as_secs_f64();
    assert!(took_s > 3.98 / 0.7 - 1.0, "{took_s} s");
    let id = id_of(&output);
    let info = server.get(&format!("/v1/sessions/{id}")).await;
    assert_eq!(
        (&info["entries"], &info["live"]["counts"]["missing"]),
        (&json!(200), &json!(0))
    );
    assert_eq!(closed(&server, &id).await, wanted);
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_session_refuses_is_told_with_its_line() {
    let (data, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &[]);
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m\n1,1,radar,a,1,2\n2,2,radar,b,3,4\n3,3,radar,c,1e12,4\n4,4,radar,d,5,6\n";
    let sample = Sample {
        bytes: text.as_bytes().to_vec(),
        ..table()
    };
    let file = sample.file(folder.path());
    let refused = sample
        .command(&server, folder.path(), &file)
        .arg("--speed=max")
        .output()
        .unwrap();
    assert_eq!(refused.status.code(), Some(1));
    let told = "line 4, sensor 'own' at 3 s: /detections/0/x_m: 1000000000000 is outside the allowed range";
    assert!(said(&refused).contains(told), "{}", said(&refused));
    let mut command = sample.command(&server, folder.path(), &file);
    let output = done(
        command
            .args(["--speed=max", "--skip-faults"])
            .output()
            .unwrap(),
    );
    assert!(
        said(&output).starts_with("3 scans, 3 detections, acknowledged to 4.0 s, 1 refused;"),
        "{}",
        said(&output)
    );
    let mut command = sample.feed(&server, &file);
    let unknown = command.args(["--session", "nobody"]).output().unwrap();
    assert_eq!(unknown.status.code(), Some(1));
    assert!(
        said(&unknown).contains("no open session is called 'nobody'"),
        "{}",
        said(&unknown)
    );
    let away = trackloom()
        .args([
            "feed",
            "--server",
            "http://127.0.0.1:9",
            "--patience",
            "0.5",
            &file,
            "--session",
            "x",
        ])
        .output()
        .unwrap();
    assert_eq!(away.status.code(), Some(1));
    assert!(said(&away).contains("no answer within"), "{}", said(&away));
}

/// What a process has held at most (kB).
fn peak_kb(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM:"))
        .unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_hostile_stream_is_counted_in_bounded_memory() {
    let (data, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &[]);
    for (sample, format) in [
        (table(), "csv"),
        (records(), "json"),
        (ais(), "ais"),
        (asterix(), "asterix"),
    ] {
        let wanted = sample.uploaded(&server).await;
        let middle = datagrams(&sample);
        let (first, second) = middle.split_at(middle.len() / 2);
        let mut command = sample.command(&server, folder.path(), "-");
        command.args(["--format", format]).stdin(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut input = child.stdin.take().unwrap();
        input.write_all(&first.concat()).unwrap();
        // An endless line of what is neither text nor a block.
        let garbage = vec![0xfe; 1 << 20];
        for _ in 0..48 {
            input.write_all(&garbage).unwrap();
        }
        if sample.is_text {
            input
                .write_all(b"\n\"unclosed,quote\n\xff\xff,\x00\n")
                .unwrap();
        }
        input.write_all(&second.concat()).unwrap();
        let held_kb = peak_kb(child.id());
        assert!(held_kb < 150_000, "{format}: {held_kb} kB");
        // Half a block, or half a line.
        input.write_all(&[48, 1, 0, 7]).unwrap();
        drop(input);
        let output = done(child.wait_with_output().unwrap());
        let told = said(&output);
        assert!(
            told.contains("rejected: ") && !told.contains("panicked"),
            "{told}"
        );
        assert_eq!(
            closed(&server, &id_of(&output)).await.measured(),
            wanted.measured(),
            "{format}: {told}"
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn scans_that_sessions_take_are_passed_on() {
    let (data, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &[]);
    let mut lines = String::new();
    for scan in 1..=50_u32 {
        let detections: Vec<Value> = (0..scan % 3)
            .map(|one| json!({"x_m": scan, "y_m": one}))
            .collect();
        let line =
            json!({"sensor_id": "own", "sequence": scan, "time_s": scan, "detections": detections});
        lines.push_str(&format!("{line}\n"));
    }
    let sample = Sample {
        bytes: lines.into_bytes(),
        name: "scans.ndjson",
        ..table()
    };
    let file = sample.file(folder.path());
    let mut command = sample.command(&server, folder.path(), &file);
    let output = done(command.arg("--speed=max").output().unwrap());
    let id = id_of(&output);
    // The same again over the standard input: the session has it all.
    let mut command = sample.feed(&server, "-");
    command.args(["--session", &format!("{}/v1/sessions/{id}", server.url)]);
    let again = from_stdin(command, &sample.bytes, 100);
    assert!(
        said(&again).starts_with("0 scans, 0 detections, acknowledged to 50.0 s"),
        "{}",
        said(&again)
    );
    assert!(said(&again).contains("50 there before"), "{}", said(&again));
    let info = server.get(&format!("/v1/sessions/{id}")).await;
    assert_eq!(
        (&info["entries"], &info["live"]["counts"]["detections"]),
        (&json!(50), &json!(51))
    );
}

/// Reads one request; gives its body.
fn request_of(connection: &mut TcpStream) -> String {
    let mut reader = BufReader::new(connection);
    let (mut line, mut length) = (String::new(), 0);
    while reader.read_line(&mut line).unwrap() > 2 {
        if let Some(value) = line.to_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse().unwrap();
        }
        line.clear();
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).unwrap();
    String::from_utf8(body).unwrap()
}

fn answer(connection: &mut TcpStream, head: &str, body: &str) {
    let length = body.len();
    let text =
        format!("HTTP/1.1 {head}\r\nconnection: close\r\ncontent-length: {length}\r\n\r\n{body}");
    connection.write_all(text.as_bytes()).unwrap();
}

/// A service that is full, fails, hangs up and then takes: the same scans come each time.
#[test]
fn a_service_that_is_busy_or_fails_is_asked_again_with_the_same_scans() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.csv");
    std::fs::write(
        &path,
        "time_s,scan,sensor_id,detection_id,x_m,y_m\n1,1,own,a,1,2\n2,2,own,b,3,4\n",
    )
    .unwrap();
    let service = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", service.local_addr().unwrap());
    let session = format!("{url}/v1/sessions/some");
    let mut command = trackloom();
    command
        .args(["feed", "--session", &session, "--speed", "max"])
        .arg(&path);
    let since = Instant::now();
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    let info = r#"{"id": "some", "state": "open", "request": {"sensors": [{"sensor_id": "own"}]}, "live": {"sensors": []}}"#;
    let taken = r#"{"scans": [{"fate": "taken"}, {"fate": "duplicate"}]}"#;
    let answers = [
        ("200 OK", info),
        ("429 Too Many Requests\r\nretry-after: 2", ""),
        ("503 Service Unavailable", ""),
        ("", ""),
        ("200 OK", taken),
    ];
    let mut bodies = Vec::new();
    for (head, body) in answers {
        let (mut connection, _) = service.accept().unwrap();
        bodies.push(request_of(&mut connection));
        if !head.is_empty() {
            answer(&mut connection, head, body);
        }
    }
    let output = done(child.wait_with_output().unwrap());
    assert!(
        since.elapsed() >= Duration::from_secs(2),
        "{:?}",
        since.elapsed()
    );
    assert_eq!(bodies[1].lines().count(), 2);
    assert!(
        bodies[2..].iter().all(|body| *body == bodies[1]),
        "{bodies:?}"
    );
    let told = said(&output);
    assert!(
        told.starts_with("1 scans, 1 detections, acknowledged to 2.0 s, 1 there before;"),
        "{told}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn sensors_that_are_none_of_the_session_are_left_out_and_counted() {
    let (data, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &[]);
    let mut text = String::from("time_s,scan,sensor_id,detection_id,x_m,y_m\n");
    for scan in 0..10 {
        text.push_str(&format!(
            "{scan},{scan},radar,a{scan},{scan},1\n{scan}.5,{scan},lidar,b{scan},{scan},2\n"
        ));
    }
    let sample = Sample {
        bytes: text.into_bytes(),
        ..table()
    };
    let file = sample.file(folder.path());
    for source in [file.as_str(), "-"] {
        let mut command = sample.command(&server, folder.path(), source);
        command.args(["--speed", "max"]);
        let output = from_stdin(command, &sample.bytes, 50);
        let told = said(&output);
        assert!(
            told.contains("read 20 lines = 10 used + 10 ignored + 0 rejected"),
            "{told}"
        );
        assert!(
            told.contains("nobody says which sensor of the session 'lidar' is"),
            "{told}"
        );
        let found = closed(&server, &id_of(&output)).await;
        assert_eq!((found.scans, found.detections.len()), (10, 10));
        assert!(found.detections.iter().all(|(id, _)| id.starts_with('a')));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn of_two_sensors_none_is_taken_for_the_only_one_of_the_session() {
    let (data, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let server = Server::start(data.path(), &[]);
    let mut text = String::from("time_s,scan,sensor_id,detection_id,x_m,y_m\n");
    for scan in 0..10 {
        text.push_str(&format!(
            "{scan},{scan},25/1,a{scan},{scan},1\n{scan}.5,{scan},25/2,b{scan},{scan},2\n"
        ));
    }
    let bytes = text.into_bytes();
    let unsaid = Sample {
        bytes: bytes.clone(),
        sensor_id: "",
        ..table()
    };
    let second = Sample {
        bytes,
        sensor_id: "25/2",
        ..table()
    };
    let file = unsaid.file(folder.path());
    let wanted = [
        "which sensor of the session '25/1' is",
        "'25/1' was taken for the only sensor, but there is '25/2', too",
    ];
    for (source, wanted) in [file.as_str(), "-"].into_iter().zip(wanted) {
        let mut command = unsaid.command(&server, folder.path(), source);
        command.args(["--speed", "max"]);
        let told = refused(command, &unsaid.bytes);
        assert!(told.contains(wanted), "{source}: {told}");
        let mut command = second.command(&server, folder.path(), source);
        command.args(["--speed", "max"]);
        let output = from_stdin(command, &second.bytes, 50);
        let found = closed(&server, &id_of(&output)).await;
        assert_eq!((found.scans, found.detections.len()), (10, 10), "{source}");
        assert!(found.detections.iter().all(|(id, _)| id.starts_with('b')));
    }
}
