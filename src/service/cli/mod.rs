//! The command line: reads arguments, calls the rest, and turns what happened into an exit code.

mod access;
mod build_server;
mod catalogue;
mod compare;
mod convert;
mod demo;
mod demo_live;
mod feed;
mod files;
mod inspect;
mod keys;
mod out;
mod output;
mod reading;
mod report;
mod run;
mod settings;
mod size;
mod table;

use crate::service::build_info;
use crate::service::child;
use crate::service::config::Config;
use crate::service::storage::blobs::BucketUrl;
use crate::service::storage::room::MinFree;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::io::IsTerminal;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use tracing_subscriber::EnvFilter;

/// Data association, track correlation and track evaluation: service, dashboard and command line.
#[derive(Parser)]
#[command(name = "trackloom", version = build_info::LONG_VERSION)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run the service with its dashboard and its workers
    Serve(ServeArguments),
    /// Run the jobs of a service as a further process, on any machine that reaches its database
    Worker(WorkerArguments),
    /// Run one job without a server
    Run(run::RunArguments),
    /// Hold one result against another, pair by pair, and say which is better
    Compare(compare::CompareArguments),
    /// Make one page of what a run left, which needs no service and no network
    Report(report::ReportArguments),
    /// Read a file of detections, truth or tracks, and write it in another format
    Convert(convert::ConvertArguments),
    /// Push what a file, standard input, UDP or TCP brings into a live session
    #[command(
        mut_arg("file", |argument| argument.value_name("FILE|-|udp://HOST:PORT|tcp://HOST:PORT").help("What to read: a file, - for standard input, datagrams that come to an address, or what a server sends")),
        mut_arg("kind", |argument| argument.hide(true)),
        mut_arg("sensors", |argument| argument.hide(true)),
        mut_arg("format", |argument| argument.help("The format; told from the content when absent. `scans` is what sessions take, one scan a line"))
    )]
    Feed(feed::FeedArguments),
    /// Say what a file holds, how its units fared, what seems wrong, and which job to start from
    Inspect(inspect::InspectArguments),
    /// Run the tour: a simulated scene and a radar recording, judged; then serve the dashboard with both
    Demo {
        #[command(flatten)]
        serve: ServeArguments,
        /// End after the tour instead of serving
        #[arg(long)]
        once: bool,
    },
    /// Make, list and revoke the keys of a service that asks for them
    Keys(keys::KeysArguments),
    /// List the methods, or the parameters of one
    Methods(catalogue::MethodsArguments),
    /// List the presets, or print one of them as a job file
    Presets(catalogue::PresetsArguments),
    /// Do what a service says through the standard input; a service starts it by itself
    #[command(hide = true)]
    Child {
        #[arg(long)]
        memory: Option<u64>,
    },
    /// Print the OpenAPI document
    Openapi {
        /// Version of the OpenAPI specification
        #[arg(long, value_enum, default_value = "3.1")]
        version: OpenapiVersion,
    },
}

impl Command {
    /// How it serves, if it does.
    fn listener(&self) -> Option<&ServeArguments> {
        match self {
            Command::Serve(serve) | Command::Demo { serve, once: false } => Some(serve),
            _ => None,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum OpenapiVersion {
    #[value(name = "3.1")]
    V31,
    #[value(name = "3.0")]
    V30,
}

#[derive(Args)]
struct ServeArguments {
    /// Address to listen on; port 0 takes any free port
    #[arg(long, env = "TRACKLOOM_LISTEN", default_value = "127.0.0.1:8080")]
    listen: SocketAddr,
    /// Where others reach this server, such as http://tracker-1.example.org:8080: told to who asks another server for a session that
    /// this one has; the address on which it listens when absent
    #[arg(long, env = "TRACKLOOM_PUBLIC_URL", value_name = "URL")]
    public_url: Option<String>,
    /// Data directory: database, uploads, results
    #[arg(long, env = "TRACKLOOM_DATA_DIR", default_value = "trackloom-data")]
    data: PathBuf,
    /// PostgreSQL for jobs, shared with other processes, such as postgres://user:password@host/database; a file in the directory when absent
    #[arg(long, env = "TRACKLOOM_DATABASE_URL", hide_env_values = true)]
    database_url: Option<String>,
    /// Keep the files of datasets and jobs in this S3-compatible bucket, s3://BUCKET or s3://BUCKET/PREFIX, instead of in
    /// the directory; the variables AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_ENDPOINT, AWS_REGION and AWS_ALLOW_HTTP
    /// say how to reach it. Needs a program built with the feature s3
    #[arg(long, env = "TRACKLOOM_ARTIFACTS", value_name = "URL")]
    artifacts: Option<BucketUrl>,
    /// Jobs that run at the same time; as many as there are processors when absent
    #[arg(long, env = "TRACKLOOM_WORKERS", value_parser = clap::value_parser!(u16).range(1..=256))]
    workers: Option<u16>,
    /// Memory that one job may use besides the program itself, such as 2GiB or 512MiB: the memory of the machine, or of its container,
    /// divided by the jobs that run at the same time and two more, when absent. A job that needs more fails with memory_limit
    #[arg(long, env = "TRACKLOOM_JOB_MEMORY", value_name = "SIZE", value_parser = size::job_memory)]
    job_memory: Option<u64>,
    /// Largest accepted upload in bytes
    #[arg(long, env = "TRACKLOOM_MAX_UPLOAD_BYTES", default_value_t = 1 << 30)]
    max_upload_bytes: u64,
    /// What has to stay free on the disk of the directory, in bytes or percent: below it uploads and new jobs are refused. The smaller of
    /// 5% and 1 GiB when absent
    #[arg(long, env = "TRACKLOOM_MIN_FREE", value_name = "BYTES|PERCENT")]
    min_free: Option<MinFree>,
    /// What files and tables may take together, such as 50GiB: above it the jobs that ended first are deleted, with the datasets that they
    /// made, unless they are pinned; where none may go, uploads and new jobs are refused. No limit when absent
    #[arg(long, env = "TRACKLOOM_MAX_DATA", value_name = "SIZE", value_parser = size::kept)]
    max_data: Option<u64>,
    /// How many jobs that have ended are kept; older ones are deleted unless they are pinned. All when absent
    #[arg(long, env = "TRACKLOOM_KEEP_JOBS", value_name = "COUNT")]
    keep_jobs: Option<u64>,
    #[command(flatten)]
    access: access::AccessArguments,
    /// Jobs that may be queued before a new one is refused
    #[arg(long, env = "TRACKLOOM_QUEUE_LIMIT", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    queue_limit: u64,
    #[command(flatten)]
    jobs: JobArguments,
    #[command(flatten)]
    settings: SettingsArguments,
}

/// Of every process that runs jobs.
#[derive(Args)]
struct JobArguments {
    /// Seconds after which a running job fails with time_limit
    #[arg(long, env = "TRACKLOOM_JOB_TIME_LIMIT", value_name = "SECONDS", default_value_t = 3600, value_parser = clap::value_parser!(u64).range(1..=31_536_000))]
    job_time_limit: u64,
}

impl JobArguments {
    fn apply(&self, config: &mut Config) {
        config.job_time_limit = Duration::from_secs(self.job_time_limit);
    }
}

impl ServeArguments {
    fn config(&self) -> Config {
        let mut config = Config::new(&self.data);
        config.listen = self.listen;
        config.public_url.clone_from(&self.public_url);
        self.access.apply(&mut config);
        config.queue_limit = self.queue_limit;
        self.jobs.apply(&mut config);
        config.artifacts.clone_from(&self.artifacts);
        config.max_upload_bytes = self.max_upload_bytes;
        config.min_free = self.min_free.unwrap_or_default();
        config.max_data_bytes = self.max_data;
        config.keep_jobs = self.keep_jobs;
        config.database_url.clone_from(&self.database_url);
        config.job_memory_bytes = self.job_memory;
        if let Some(workers) = self.workers {
            config.slots = usize::from(workers);
        }
        config
    }
}

/// Of every process that runs for long.
#[derive(Args)]
struct SettingsArguments {
    /// File of settings, a NAME=value a line with the names of the variables: what neither an argument nor a variable says
    #[arg(long, env = "TRACKLOOM_CONFIG", value_name = "FILE")]
    config: Option<PathBuf>,
    /// How lines of the log on stderr are written: for people, or as JSON, one object a line
    #[arg(long, env = "TRACKLOOM_LOG_FORMAT", value_enum, default_value = "text")]
    log_format: LogFormat,
}

#[derive(Clone, Copy, ValueEnum)]
enum LogFormat {
    Text,
    Json,
}

#[derive(Args)]
struct WorkerArguments {
    /// PostgreSQL of the service, such as postgres://user:password@host/database
    #[arg(long, env = "TRACKLOOM_DATABASE_URL", hide_env_values = true)]
    database_url: String,
    /// Jobs that run at the same time; as many as there are processors when absent
    #[arg(long, env = "TRACKLOOM_SLOTS", value_parser = clap::value_parser!(u16).range(1..=256))]
    slots: Option<u16>,
    /// Memory that one job may use besides the program itself, such as 2GiB or 512MiB: the memory of the machine, or of its container,
    /// divided by the jobs that run at the same time and two more, when absent. A job that needs more fails with memory_limit
    #[arg(long, env = "TRACKLOOM_JOB_MEMORY", value_name = "SIZE", value_parser = size::job_memory)]
    job_memory: Option<u64>,
    /// The data directory of the service, which both must reach; with a bucket, any directory
    #[arg(long, env = "TRACKLOOM_DATA_DIR", default_value = "trackloom-data")]
    data: PathBuf,
    /// The bucket of the service, if it keeps files in one
    #[arg(long, env = "TRACKLOOM_ARTIFACTS", value_name = "URL")]
    artifacts: Option<BucketUrl>,
    #[command(flatten)]
    jobs: JobArguments,
    #[command(flatten)]
    settings: SettingsArguments,
}

impl WorkerArguments {
    fn config(&self) -> Config {
        let mut config = Config::new(&self.data);
        config.database_url = Some(self.database_url.clone());
        self.jobs.apply(&mut config);
        config.artifacts.clone_from(&self.artifacts);
        config.job_memory_bytes = self.job_memory;
        if let Some(slots) = self.slots {
            config.slots = usize::from(slots);
        }
        config
    }
}

/// Bad input: of the arguments, of a job file, or of a data file.
const BAD_INPUT: u8 = 2;

/// Runs the command of the process's arguments. Exit codes: 0 done, 1 failed, 2 bad input.
pub fn main() -> ExitCode {
    crate::service::panics::hold_while_reading();
    let command = match settings::arguments() {
        Ok(arguments) => arguments.command,
        Err(refusal) => {
            eprintln!("trackloom: {refusal}");
            return ExitCode::from(BAD_INPUT);
        }
    };
    if let Some(Err(refusal)) = command
        .listener()
        .map(|serve| serve.access.check(serve.listen))
    {
        eprintln!("trackloom: {refusal}");
        return ExitCode::from(BAD_INPUT);
    }
    let result = match command {
        Command::Serve(arguments) => {
            let service = crate::service::server::serve(arguments.config());
            blocking(&arguments.settings, service)
        }
        Command::Worker(arguments) => {
            let work = crate::service::server::work(arguments.config());
            blocking(&arguments.settings, work)
        }
        Command::Run(arguments) => return run::run(&arguments),
        Command::Compare(arguments) => return compare::run(&arguments),
        Command::Report(arguments) => return report::run(&arguments),
        Command::Convert(arguments) => return convert::convert(&arguments),
        Command::Feed(arguments) => return feed::run(&arguments),
        Command::Inspect(arguments) => return inspect::run(&arguments),
        Command::Keys(arguments) => return keys::run(&arguments),
        Command::Demo { serve, once } => {
            blocking(&serve.settings, demo::demo(serve.config(), once))
        }
        Command::Methods(arguments) => return catalogue::print_methods(&arguments),
        Command::Presets(arguments) => return catalogue::print_presets(&arguments),
        Command::Child { memory } => child::run(memory),
        Command::Openapi { version } => {
            return catalogue::print_openapi(matches!(version, OpenapiVersion::V30));
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("trackloom: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// What the service says of itself goes to stderr, as much as `RUST_LOG` asks for.
fn log(settings: &SettingsArguments) {
    let level =
        EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("warn,trackloom=info"));
    let stderr = std::io::stderr;
    let log = tracing_subscriber::fmt()
        .with_env_filter(level)
        .with_writer(stderr)
        .with_ansi(stderr().is_terminal());
    match settings.log_format {
        LogFormat::Text => log.init(),
        LogFormat::Json => log.json().flatten_event(true).init(),
    }
    if let Some(path) = &settings.config {
        tracing::info!(file = %path.display(), "settings");
    }
}

/// Runs the service on a runtime of its own.
fn blocking(
    settings: &SettingsArguments,
    service: impl Future<Output = anyhow::Result<()>>,
) -> anyhow::Result<()> {
    log(settings);
    tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()?
        .block_on(service)
}
