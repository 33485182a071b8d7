//! `trackloom feed`: what a file, the standard input, UDP or TCP brings, pushed into a live session.

mod arrivals;
mod client;
mod inlets;
mod places;
mod progress;
mod pusher;
mod queue;
mod ready;
mod recorded;
mod sensors;
mod stop;
mod streamed;
mod teller;

use super::reading::ReadArguments;
use super::run::{Trouble, end};
use crate::formats::{Format, ReadOptions};
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::service::cli::output;
use anyhow::{Context, anyhow};
use clap::Args;
use client::{Client, SessionSeen};
use progress::Progress;
use pusher::Pusher;
use sensors::Mapping;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Duration;
use stop::Stop;

#[derive(Args)]
pub(super) struct FeedArguments {
    #[command(flatten)]
    read: ReadArguments,
    /// Where the service is
    #[arg(
        long,
        env = "TRACKLOOM_SERVER",
        value_name = "URL",
        default_value = "http://127.0.0.1:8080"
    )]
    server: String,
    /// The session: its id, its URL, or its name
    #[arg(
        long,
        value_name = "ID|URL|NAME",
        required_unless_present = "create",
        conflicts_with = "create"
    )]
    session: Option<String>,
    /// Make the session from this body of a request, and print its id
    #[arg(long, value_name = "FILE")]
    create: Option<PathBuf>,
    /// What a sensor of the file is called in the session. Not needed where names are the same, or each has one sensor
    #[arg(long = "sensor", value_name = "FILE_ID=SESSION_ID")]
    named_sensors: Vec<String>,
    /// How fast a file is pushed, in times of its own pace: a number, or max
    #[arg(long, default_value = "1")]
    speed: Speed,
    /// Period of the scans that reports without scans are gathered in (s); 10 when absent. The same as --option frame_s
    #[arg(long, value_name = "SECONDS")]
    scan_s: Option<f64>,
    /// How long the scan of a stream waits for more: by the times of its sensor's data, or by the clock (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, value_parser = seconds)]
    settle_s: f64,
    /// How long the feed goes on asking a service that is away or fails (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    patience: f64,
    /// Count what the session refuses, and go on; otherwise it ends the feed
    #[arg(long)]
    skip_faults: bool,
}

/// Seconds that a person waits for.
fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok();
    let allowed = seconds.filter(|seconds| (0.0..=1e6).contains(seconds));
    allowed.ok_or_else(|| "give seconds from 0 to 1000000".to_owned())
}

/// Times the pace of the recording; none: as fast as it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Speed(Option<f64>);

impl FromStr for Speed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "max" {
            return Ok(Speed(None));
        }
        let times: Option<f64> = text.parse().ok();
        let times = times.filter(|times| (1e-3..=1e6).contains(times));
        times.map(|times| Speed(Some(times))).ok_or_else(|| {
            "give max, or how many times the pace of the recording, 0.001 to 1000000".to_owned()
        })
    }
}

/// Where it comes from.
enum Source {
    File(PathBuf),
    Stdin,
    /// An address to listen on.
    Udp(String),
    /// An address to connect to.
    Tcp(String),
}

impl FeedArguments {
    fn source(&self) -> Source {
        let text = self.read.file.to_string_lossy();
        if let Some(address) = text.strip_prefix("udp://") {
            Source::Udp(address.to_owned())
        } else if let Some(address) = text.strip_prefix("tcp://") {
            Source::Tcp(address.to_owned())
        } else if text == "-" {
            Source::Stdin
        } else {
            Source::File(self.read.file.clone())
        }
    }

    /// Whether what comes is what sessions take.
    fn is_of_scans(&self) -> bool {
        self.read.format.as_deref() == Some("scans")
    }

    /// The format, where it is said, and what its reader has to know, with what the session knows.
    fn told(
        &self,
        session: &SessionSeen,
    ) -> Result<(Option<&'static Format>, ReadOptions), Vec<Fault>> {
        let (format, mut options) = if self.is_of_scans() {
            (None, ReadOptions::default())
        } else {
            self.read.told(DatasetKind::Detections)?
        };
        if let Some(scan_s) = self.scan_s {
            options.options.add("frame_s", &Some(scan_s));
        }
        if self.skip_faults {
            options.options.add("max_rejected", &Some(1.0));
        }
        options.options.add("origin", &session.request.origin);
        Ok((format, options))
    }
}

/// All that a feed needs, wherever it comes from.
struct Feeding<'a> {
    arguments: &'a FeedArguments,
    session: SessionSeen,
    mapping: Mapping,
    pusher: Pusher,
    stop: Stop,
}

pub(super) fn run(arguments: &FeedArguments) -> ExitCode {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let done = match runtime {
        Ok(runtime) => {
            let done = runtime.block_on(feed(arguments));
            // A thread that still waits for input is no reason to stay.
            runtime.shutdown_background();
            done
        }
        Err(error) => Err(Trouble::Failed(error.into())),
    };
    end(done, "the feed cannot be read")
}

async fn feed(arguments: &FeedArguments) -> Result<(), Trouble> {
    let patience = Duration::from_secs_f64(arguments.patience);
    let client = Client::new(&arguments.server, patience)?;
    let session = session(arguments, &client).await?;
    let mapping = Mapping::new(&arguments.named_sensors, session.sensor_ids())?;
    let source = arguments.source();
    let mut feeding = Feeding {
        arguments,
        mapping,
        pusher: Pusher {
            client,
            scans_url: format!("{}/scans", session.url),
            skips_faults: arguments.skip_faults,
            places: None,
            progress: Progress::new(),
        },
        session,
        stop: Stop::on_signals()?,
    };
    let fed = match &source {
        Source::File(path) => recorded::feed(&mut feeding, path).await,
        source => streamed::feed(&mut feeding, source).await,
    };
    feeding.pusher.progress.end();
    fed
}

/// The session that is named, or that is made.
async fn session(arguments: &FeedArguments, client: &Client) -> Result<SessionSeen, Trouble> {
    let Some(path) = &arguments.create else {
        let named = arguments.session.as_deref().unwrap_or_default();
        return Ok(client.find(named).await?);
    };
    let text =
        std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let body = serde_json::from_str(&text)
        .map_err(|error| anyhow!("{} is no JSON: {error}", path.display()))?;
    let made = client.create(&body).await?;
    output::print(&made.id).context("cannot tell the session")?;
    Ok(made)
}

/// The fault of latitudes in a session whose plane is nowhere on the Earth.
fn no_origin() -> Vec<Fault> {
    let detail = "it gives latitudes and longitudes, and the session has no origin";
    vec![
        Fault::new("/origin", "no_frame", detail)
            .allowing("an origin of the session, or --origin of its plane"),
    ]
}
