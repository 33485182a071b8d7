//! Names the version with its revision, and builds the dashboard when Node.js and npm are there, so that the binary can carry it. Without them, or when
//! `TRACKLOOM_SKIP_DASHBOARD` is set, the service still builds and says at `/` what is missing.

use std::path::Path;
use std::process::Command;
use std::{env, fs, io};

/// What the dashboard is made of. Everything that is written (`dist`, `node_modules`, `generated`) lies outside.
const SOURCES: [&str; 7] = [
    "static/src",
    "static/build.mjs",
    "static/package.json",
    "static/package-lock.json",
    "static/.npmrc",
    "static/tsconfig.json",
    "openapi/openapi.json",
];

fn main() {
    println!("cargo:rerun-if-changed=static/build.rs");
    name_version();
    println!("cargo:rerun-if-env-changed=TRACKLOOM_SKIP_DASHBOARD");
    for source in SOURCES {
        println!("cargo:rerun-if-changed={source}");
    }
    if let Err(error) = fs::create_dir_all("static/dist") {
        println!("cargo:warning=static/dist cannot be created: {error}");
    }
    if env::var_os("TRACKLOOM_SKIP_DASHBOARD").is_some() {
        return;
    }
    if let Err(reason) = build_dashboard(Path::new("static")) {
        // A page of an older source must not pass for this one.
        let _ = fs::remove_file("static/dist/index.html");
        println!("cargo:warning=built without the dashboard: {reason}");
    }
}

/// The revision of a release; a build for development would be made anew with each commit.
fn name_version() {
    let version = env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let is_release = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let revision = if is_release {
        git(&["rev-parse", "--short=12", "HEAD"])
    } else {
        None
    };
    match revision {
        Some(revision) => {
            if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
                println!("cargo:rerun-if-changed={log}");
            }
            println!("cargo:rustc-env=TRACKLOOM_VERSION={version}+{revision}");
        }
        None => println!("cargo:rustc-env=TRACKLOOM_VERSION={version}"),
    }
    let optional = [
        ("CARGO_FEATURE_S3", "s3"),
        ("CARGO_FEATURE_PARQUET", "parquet"),
    ];
    let built: Vec<&str> = optional
        .iter()
        .filter(|(set, _)| env::var_os(set).is_some())
        .map(|(_, name)| *name)
        .collect();
    println!(
        "cargo:rustc-env=TRACKLOOM_FEATURES={}",
        if built.is_empty() {
            "none".to_owned()
        } else {
            built.join(" ")
        }
    );
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git")
        .args(arguments)
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn build_dashboard(folder: &Path) -> Result<(), String> {
    run(folder, "node", &["--version"])?;
    install_packages(folder)?;
    run(folder, "node", &["build.mjs"])
}

/// Installs what the lock file names and the dashboard is built with, unless that very lock file was installed before.
/// What only checks the source is left to `tests/run style`.
fn install_packages(folder: &Path) -> Result<(), String> {
    let lock = fs::read(folder.join("package-lock.json")).map_err(|error| error.to_string())?;
    let installed = folder.join("node_modules/.installed-lock.json");
    if fs::read(&installed).is_ok_and(|before| before == lock) {
        return Ok(());
    }
    run(
        folder,
        "npm",
        &[
            "ci",
            "--omit=dev",
            "--ignore-scripts",
            "--no-audit",
            "--no-fund",
        ],
    )?;
    fs::write(&installed, lock).map_err(|error| error.to_string())
}

fn run(folder: &Path, program: &str, arguments: &[&str]) -> Result<(), String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output();
    let output = output.map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => format!("{program} is not installed"),
        _ => format!("{program} cannot be started: {error}"),
    })?;
    if output.status.success() {
        return Ok(());
    }
    let message = String::from_utf8_lossy(&output.stderr).replace('\n', " ");
    Err(format!(
        "{program} {} failed: {message}",
        arguments.join(" ")
    ))
}
