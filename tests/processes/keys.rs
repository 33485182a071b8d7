//! Keys as whoever runs a service meets them.

use crate::process::{Process, Server, trackloom};
use serde_json::json;
use std::fs::File;
use std::process::{Command, Output};

const MASTER: &str = "0123456789abcdef0123456789abcdef";

fn keys(server: &Server, key: &str, arguments: &[&str]) -> Output {
    let mut command = trackloom();
    command.env("TRACKLOOM_MASTER_KEY", key);
    let output = command
        .arg("keys")
        .args(arguments)
        .args(["--server", &server.url]);
    output.output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap().trim().to_owned()
}

/// What a service says of itself goes to this file, all of it.
fn serve(command: &mut Command, log: &std::path::Path) -> Server {
    let log = File::create(log).unwrap();
    let command = command.env("RUST_LOG", "trace").stderr(log);
    Server::of(Process::start(command))
}

#[tokio::test]
async fn keys_are_made_used_listed_revoked_and_never_logged() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("master");
    std::fs::write(&file, format!("{MASTER}\n")).unwrap();
    let mut command = trackloom();
    // Whoever asks for keys may listen for others.
    command.args(["serve", "--listen", "0.0.0.0:0", "--master-key-file"]);
    command
        .arg(&file)
        .arg("--data")
        .arg(folder.path().join("data"));
    let log = folder.path().join("log");
    let mut server = serve(&mut command, &log);
    server.url = server.url.replace("0.0.0.0", "127.0.0.1");
    let refused = keys(
        &server,
        "another master key".replace(' ', "-").as_str(),
        &["list"],
    );
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).ends_with("the key is not one of this service"));
    let made = keys(
        &server,
        MASTER,
        &["add", "feed of the north", "--allow", "push,sessions,read"],
    );
    let key = text(&made.stdout);
    assert!(key.starts_with("tlk_") && key.len() == 101, "{made:?}");
    let listed = text(&keys(&server, MASTER, &["list"]).stdout);
    assert!(
        listed.ends_with("push,sessions,read  ends never  feed of the north"),
        "{listed}"
    );
    let id = listed.split(' ').next().unwrap().to_owned();
    let get = async |key: &str| {
        let request = server
            .client
            .get(format!("{}/v1/jobs", server.url))
            .bearer_auth(key);
        request.send().await.unwrap().status().as_u16()
    };
    assert_eq!(
        (get(&key).await, get(MASTER).await, get("x").await),
        (200, 200, 401)
    );

    // A feed takes the key of its environment.
    let scans = folder.path().join("scans.csv");
    std::fs::write(
        &scans,
        "time_s,sensor_id,x_m,y_m\n0,radar,1,2\n1,radar,2,3\n",
    )
    .unwrap();
    let session = folder.path().join("session.json");
    let sensor = json!({"sensor_id": "radar", "sigma_x_m": 10.0, "sigma_y_m": 10.0, "p_d": 0.9, "clutter_per_m2": 1e-8});
    let body = json!({"sensors": [sensor], "tracker": {"initial_speed_sigma_mps": 10.0}});
    std::fs::write(&session, body.to_string()).unwrap();
    let feed = |key: Option<&str>| {
        let mut command = trackloom();
        command.args([
            "feed",
            "--server",
            &server.url,
            "--speed",
            "max",
            "--create",
        ]);
        command.arg(&session).arg(&scans);
        if let Some(key) = key {
            command.env("TRACKLOOM_API_KEY", key);
        }
        command.output().unwrap()
    };
    let fed = feed(Some(&key));
    assert!(fed.status.success(), "{}", text(&fed.stderr));
    let shut = feed(None);
    assert!(!shut.status.success() && text(&shut.stderr).contains("the request has no key"));

    assert!(keys(&server, MASTER, &["revoke", &id]).status.success());
    assert_eq!(get(&key).await, 401);
    assert_eq!(server.terminate().0, Some(0));
    let said = std::fs::read_to_string(log).unwrap();
    assert!(said.contains(&id), "who asked is in the log");
    let secret = key.rsplit('_').next().unwrap();
    assert!(
        !said.contains(secret) && !said.contains(MASTER),
        "no key is"
    );
}

#[test]
fn a_master_key_that_can_be_guessed_is_refused() {
    let data = tempfile::tempdir().unwrap();
    let serve = |key: &str| {
        let mut command = trackloom();
        command.args(["serve", "--listen", "127.0.0.1:0", "--data"]);
        let output = command
            .arg(data.path().join("none"))
            .env("TRACKLOOM_MASTER_KEY", key);
        let output = output.output().unwrap();
        (text(&output.stderr), output.status.code())
    };
    let (said, code) = serve("fifteen-letters");
    assert_eq!(
        (said.as_str(), code),
        (
            "trackloom: the master key has 15 bytes; it needs at least 16, such as those of `openssl rand -hex 32`",
            Some(2)
        )
    );
    let (said, code) = serve("sixteen letters !");
    assert!(
        said.contains("printable ASCII") && code == Some(2),
        "{said}"
    );
    let mut command = trackloom();
    command.args(["serve", "--master-key-file", "/nowhere/at/all"]);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("/nowhere/at/all"));
}
