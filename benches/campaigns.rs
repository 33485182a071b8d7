//! What the queue costs a campaign, and what a second worker brings: Liang's scenes at five densities under three associators.
//!
//! Each part runs the program as a user would, one process after the other, and asks the system for processor time and memory.
//! `cargo bench --bench campaigns` takes some minutes; `-- 500` makes 500 runs a cell, as the figures in the documentation have.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn main() {
    let runs = std::env::args()
        .filter_map(|argument| argument.parse().ok())
        .next()
        .unwrap_or(100);
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .unwrap();
    runtime.block_on(measure(runs));
}

async fn measure(runs: u32) {
    let folder = tempfile::tempdir().unwrap();
    let body = liang(runs);
    println!(
        "campaign of {} runs: Liang's scenes, 5 densities x 3 associators x {runs}",
        15 * runs
    );

    let alone = run_alone(&body, folder.path()).await;
    println!(
        "  no queue (trackloom run)        wall {:7.1} s   processor {:7.1} s",
        alone.wall_s, alone.processor_s
    );
    let one = run_served(&body, 1).await;
    println!(
        "  service with 1 worker           wall {:7.1} s   processor {:7.1} s",
        one.wall_s, one.processor_s
    );
    let two = run_served(&body, 2).await;
    println!(
        "  service with 2 workers          wall {:7.1} s   processor {:7.1} s",
        two.wall_s, two.processor_s
    );
    let both = tokio::join!(
        run_alone(&body, folder.path()),
        run_alone(&body, folder.path())
    );
    let ceiling = 2.0 * alone.wall_s / both.0.wall_s.max(both.1.wall_s);
    println!(
        "  queue: {:+.1} % of processor time",
        100.0 * (one.processor_s / alone.processor_s - 1.0)
    );
    println!(
        "  2 workers: {:.2} x as fast as 1; two programs side by side do {ceiling:.2} x the work of one",
        one.wall_s / two.wall_s
    );

    memory(100_000).await;
}

struct Spent {
    wall_s: f64,
    processor_s: f64,
}

/// Without service, queue and tables.
async fn run_alone(body: &Value, folder: &Path) -> Spent {
    let file = folder.join("job.json");
    std::fs::write(&file, body.to_string()).unwrap();
    let since = Instant::now();
    let child = Command::new(env!("CARGO_BIN_EXE_trackloom"))
        .arg("run")
        .arg(&file)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let watch = Watch(child);
    let mut processor_s = 0.0;
    while let Some(seconds) = watch.processor_s() {
        processor_s = seconds;
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    Spent {
        wall_s: since.elapsed().as_secs_f64(),
        processor_s,
    }
}

async fn run_served(body: &Value, workers: u32) -> Spent {
    let server = Server::start(workers);
    let before_s = server.watch.processor_s().unwrap();
    let since = Instant::now();
    let id = server.submit(body).await;
    server.ended(&id).await;
    Spent {
        wall_s: since.elapsed().as_secs_f64(),
        processor_s: server.watch.processor_s().unwrap() - before_s,
    }
}

/// Memory of the service while a campaign of many short runs grows, and how long a list of jobs takes meanwhile.
async fn memory(runs: u32) {
    let server = Server::start(2);
    let body = moment(runs);
    let id = server.submit(&body).await;
    println!("campaign of {runs} short runs");
    let (mut told, mut slowest) = (0, Duration::ZERO);
    loop {
        let since = Instant::now();
        server.get("/v1/jobs?limit=50").await;
        slowest = slowest.max(since.elapsed());
        let job = server.get(&format!("/v1/jobs/{id}")).await;
        let done = job["progress"]["done"].as_u64().unwrap_or(0);
        let is_over = !["queued", "running"].contains(&job["state"].as_str().unwrap());
        if done * 5 / u64::from(runs) > told || is_over {
            told = done * 5 / u64::from(runs);
            println!(
                "  {:>9}  {:6.1} MB",
                if is_over {
                    "at the end".to_owned()
                } else {
                    done.to_string()
                },
                server.watch.megabytes()
            );
        }
        if is_over {
            assert_eq!(job["state"], "succeeded", "{job}");
            break;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    println!(
        "  slowest list of jobs {:.0} ms",
        slowest.as_secs_f64() * 1e3
    );
}

/// The preset with so many runs of each of its fifteen cells.
fn liang(runs: u32) -> Value {
    let printed = Command::new(env!("CARGO_BIN_EXE_trackloom"))
        .args(["presets", "liang2009-table1"])
        .output()
        .unwrap();
    let mut job: Value = serde_json::from_slice(&printed.stdout).unwrap();
    job["runs"] = json!(runs);
    job
}

/// One target for one scan.
fn moment(runs: u32) -> Value {
    json!({
        "runs": runs, "timed_runs": 0, "outcomes": [{"path": "counts.detections", "name": "detections"}],
        "base": {"kind": "simulate", "scenario": {
            "scans": 1, "scan_period_s": 1.0,
            "sensors": [{"sensor_id": "radar", "max_range_m": 20000.0, "p_d": 0.9, "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": 1.0}],
            "targets": {"kind": "random", "count": 1, "area_side_m": 1000.0, "speed_min_mps": 5.0, "speed_max_mps": 20.0}
        }}
    })
}

/// What the system knows of a process.
struct Watch(Child);

impl Watch {
    /// Processor time so far; `None` when it has ended.
    fn processor_s(&self) -> Option<f64> {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.0.id())).ok()?;
        let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
        let ticks: u64 = fields[11].parse::<u64>().ok()? + fields[12].parse::<u64>().ok()?;
        // Linux counts a hundred ticks a second.
        (fields[0] != "Z").then_some(ticks as f64 / 100.0)
    }

    fn megabytes(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.0.id())).unwrap();
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("VmRSS:"))
            .unwrap();
        line.split_whitespace()
            .next()
            .unwrap()
            .parse::<f64>()
            .unwrap()
            / 1024.0
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

struct Server {
    watch: Watch,
    url: String,
    client: reqwest::Client,
    _data: tempfile::TempDir,
}

impl Server {
    fn start(workers: u32) -> Server {
        let data = tempfile::tempdir().unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_trackloom"))
            .args([
                "serve",
                "--listen",
                "127.0.0.1:0",
                "--workers",
                &workers.to_string(),
                "--data",
            ])
            .arg(data.path())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut said)
            .unwrap();
        let url = said
            .trim()
            .strip_prefix("trackloom listening on ")
            .unwrap()
            .to_owned();
        Server {
            watch: Watch(child),
            url,
            client: reqwest::Client::new(),
            _data: data,
        }
    }

    async fn get(&self, path: &str) -> Value {
        self.client
            .get(format!("{}{path}", self.url))
            .send()
            .await
            .unwrap()
            .json()
            .await
            .unwrap()
    }

    async fn submit(&self, job: &Value) -> String {
        let mut body = job.clone();
        body.as_object_mut().unwrap().remove("kind");
        let answer = self
            .client
            .post(format!("{}/v1/jobs/campaign", self.url))
            .json(&body)
            .send()
            .await
            .unwrap();
        let answer: Value = answer.json().await.unwrap();
        answer["id"]
            .as_str()
            .unwrap_or_else(|| panic!("{answer}"))
            .to_owned()
    }

    async fn ended(&self, id: &str) {
        loop {
            let job = self.get(&format!("/v1/jobs/{id}")).await;
            match job["state"].as_str() {
                Some("succeeded") => return,
                Some("queued" | "running") => tokio::time::sleep(Duration::from_millis(50)).await,
                _ => panic!("{job}"),
            }
        }
    }
}
