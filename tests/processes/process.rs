//! Servers and workers as processes of their own.

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(240);

pub fn trackloom() -> Command {
    Command::new(env!("CARGO_BIN_EXE_trackloom"))
}

/// Started until it has said its first line; killed at the end of its test.
pub struct Process {
    child: Child,
    pub said: String,
}

impl Process {
    pub fn start(command: &mut Command) -> Process {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut said = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut said)
            .unwrap();
        Process {
            child,
            said: said.trim().to_owned(),
        }
    }

    pub fn worker(database_url: &str, data: &Path, slots: u32) -> Process {
        let slots = slots.to_string();
        let process = Process::start(
            trackloom()
                .args([
                    "worker",
                    "--database-url",
                    database_url,
                    "--slots",
                    &slots,
                    "--data",
                ])
                .arg(data),
        );
        assert_eq!(process.said, format!("trackloom worker with {slots} slots"));
        process
    }

    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// SIGKILL: no handler runs, nothing is tidied up.
    pub fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// SIGTERM; gives the exit code and how long it took.
    pub fn terminate(mut self) -> (Option<i32>, Duration) {
        let since = Instant::now();
        signal(self.id(), "TERM");
        (self.child.wait().unwrap().code(), since.elapsed())
    }
}

pub fn signal(process: u32, name: &str) {
    assert!(
        Command::new("kill")
            .args([&format!("-{name}"), &process.to_string()])
            .status()
            .unwrap()
            .success()
    );
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A server that cannot start: what it says and its exit code.
pub fn refused(data: &Path, arguments: &[&str]) -> (String, Option<i32>) {
    let Output { status, stderr, .. } = trackloom()
        .args(["serve", "--listen", "127.0.0.1:0", "--data"])
        .arg(data)
        .args(arguments)
        .output()
        .unwrap();
    (String::from_utf8(stderr).unwrap(), status.code())
}

/// A real server process on a free port.
pub struct Server {
    process: Process,
    pub url: String,
    pub client: reqwest::Client,
}

impl Server {
    pub fn start(data: &Path, arguments: &[&str]) -> Server {
        let mut command = trackloom();
        command
            .args(["serve", "--listen", "127.0.0.1:0", "--data"])
            .arg(data);
        if !arguments.contains(&"--workers") {
            command.args(["--workers", "2"]);
        }
        Server::of(Process::start(command.args(arguments)))
    }

    /// A process that has said where it listens.
    pub fn of(process: Process) -> Server {
        let said = &process.said;
        let url = said
            .strip_prefix("trackloom listening on ")
            .unwrap_or_else(|| panic!("said '{said}'"))
            .to_owned();
        Server {
            process,
            url,
            client: reqwest::Client::new(),
        }
    }

    pub fn id(&self) -> u32 {
        self.process.id()
    }

    pub fn kill(self) {
        self.process.kill();
    }

    pub fn terminate(self) -> (Option<i32>, Duration) {
        self.process.terminate()
    }

    /// An answer as JSON; asks again while the server says that it cannot just now.
    pub async fn get(&self, path: &str) -> Value {
        let since = Instant::now();
        loop {
            let answer = self
                .client
                .get(format!("{}{path}", self.url))
                .send()
                .await
                .unwrap();
            if answer.status() == 503 && since.elapsed() < PATIENCE {
                tokio::time::sleep(Duration::from_millis(200)).await;
                continue;
            }
            assert!(answer.status().is_success(), "{path}: {}", answer.status());
            return answer.json().await.unwrap();
        }
    }

    /// Queues a job of a kind; gives its id.
    pub async fn submit(&self, kind: &str, body: &Value) -> String {
        let answer = self
            .client
            .post(format!("{}/v1/jobs/{kind}", self.url))
            .json(body)
            .send()
            .await
            .unwrap();
        let (status, answer) = (answer.status(), answer.json::<Value>().await.unwrap());
        assert_eq!(status, 202, "{answer}");
        answer["id"].as_str().unwrap().to_owned()
    }

    /// Asks a job for something without a body: `cancel`, `rerun`.
    pub async fn ask(&self, id: &str, what: &str) -> Value {
        let answer = self
            .client
            .post(format!("{}/v1/jobs/{id}/{what}", self.url))
            .send()
            .await
            .unwrap();
        assert!(answer.status().is_success(), "{what}: {}", answer.status());
        answer.json().await.unwrap()
    }

    pub async fn job(&self, id: &str) -> Value {
        self.get(&format!("/v1/jobs/{id}")).await
    }

    pub async fn count(&self, state: &str) -> u64 {
        self.get(&format!("/v1/jobs?state={state}&limit=1&count=true"))
            .await["total"]
            .as_u64()
            .unwrap()
    }

    pub async fn until(&self, state: &str, count: u64) {
        let since = Instant::now();
        while self.count(state).await != count {
            assert!(
                since.elapsed() < PATIENCE,
                "{} jobs are {state}, not {count}",
                self.count(state).await
            );
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// Waits until the job is as wanted.
    pub async fn job_until(&self, id: &str, is_wanted: impl Fn(&Value) -> bool) -> Value {
        let since = Instant::now();
        loop {
            let job = self.job(id).await;
            if is_wanted(&job) {
                return job;
            }
            assert!(since.elapsed() < PATIENCE, "{job}");
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    }

    /// The job when it has ended.
    pub async fn ended(&self, id: &str) -> Value {
        self.job_until(id, |job| {
            !["queued", "running"].contains(&job["state"].as_str().unwrap())
        })
        .await
    }

    /// The bytes of `result` in the report of a job, which must succeed.
    pub async fn result(&self, id: &str) -> String {
        let job = self.ended(id).await;
        assert_eq!(job["state"], "succeeded", "{job}");
        let report = self
            .client
            .get(format!("{}/v1/jobs/{id}/report", self.url))
            .send()
            .await
            .unwrap()
            .text()
            .await
            .unwrap();
        report
            .split_once("\"result\":")
            .unwrap_or_else(|| panic!("{report}"))
            .1
            .to_owned()
    }
}
