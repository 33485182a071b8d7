//! Who can reach a server that is started as a user starts it.

use crate::process::{Process, trackloom};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Command;
use std::time::{Duration, Instant};

#[test]
fn an_address_that_others_reach_is_refused_unless_that_is_meant() {
    let data = tempfile::tempdir().unwrap();
    for command in ["serve", "demo"] {
        let output = trackloom()
            .args([command, "--listen", "0.0.0.0:0", "--data"])
            .arg(data.path().join("none"))
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.starts_with("trackloom: --listen 0.0.0.0:0 is refused without a master key: "),
            "{said}"
        );
        assert!(
            said.contains("--insecure") && said.contains("--master-key-file"),
            "{said}"
        );
    }
    for wrong in ["http://one.example", "one.example:80", ""] {
        let output = trackloom()
            .args(["serve", "--allow-host", wrong])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(
            String::from_utf8(output.stderr)
                .unwrap()
                .contains("without scheme and port"),
            "{wrong}"
        );
    }
    assert!(!data.path().join("none").exists(), "nothing has begun");
}

#[test]
fn a_server_that_is_meant_to_be_open_answers_by_its_address_and_by_allowed_names_alone() {
    let data = tempfile::tempdir().unwrap();
    let mut command = trackloom();
    command
        .args([
            "serve",
            "--listen",
            "0.0.0.0:0",
            "--insecure",
            "--allow-host",
            "one.example",
            "--data",
        ])
        .arg(data.path());
    let server = Process::start(command.env("TRACKLOOM_QUEUE_LIMIT", "5").args([
        "--job-time-limit",
        "9",
        "--max-connections",
        "20",
    ]));
    let port = server.said.rsplit(':').next().unwrap();
    let status = |host: &str| {
        let mut stream = TcpStream::connect(format!("127.0.0.1:{port}")).unwrap();
        stream
            .write_all(
                format!("GET /healthz HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n")
                    .as_bytes(),
            )
            .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer.split(' ').nth(1).unwrap_or_default().to_owned()
    };
    let found = [
        "127.0.0.1",
        "localhost",
        "one.example",
        "two.example",
        "0.0.0.0",
    ]
    .map(status);
    assert_eq!(found, ["200", "200", "200", "403", "403"]);
    let (code, _) = server.terminate();
    assert_eq!(code, Some(0));
}

#[test]
fn a_server_that_may_open_few_files_answers_and_refuses_while_many_connect() {
    let data = tempfile::tempdir().unwrap();
    let program = "ulimit -n 64; exec \"$0\" serve --listen 127.0.0.1:0 --data \"$1\"";
    let mut command = Command::new("sh");
    let server = Process::start(
        command
            .args(["-c", program, env!("CARGO_BIN_EXE_trackloom")])
            .arg(data.path()),
    );
    let address = server.said.rsplit('/').next().unwrap().to_owned();
    let ask = |mut stream: TcpStream| {
        stream
            .set_read_timeout(Some(Duration::from_secs(20)))
            .unwrap();
        stream
            .write_all(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            .unwrap();
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer);
        answer.split(' ').nth(1).unwrap_or_default().to_owned()
    };
    let idle: Vec<TcpStream> = (0..100)
        .map(|_| TcpStream::connect(&address).unwrap())
        .collect();
    std::thread::sleep(Duration::from_secs(3));
    assert_eq!(
        ask(TcpStream::connect(&address).unwrap()),
        "503",
        "one too many is told so"
    );
    let first = idle.into_iter().next().unwrap();
    assert_eq!(ask(first), "200", "who has a connection is served");
    let since = Instant::now();
    while ask(TcpStream::connect(&address).unwrap()) != "200" {
        assert!(
            since.elapsed() < Duration::from_secs(30),
            "the others are gone"
        );
    }
}
