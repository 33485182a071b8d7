//! The running service: built once, bound, served until it is told to stop, then drained.

use super::config::Config;
use super::connections;
use super::http::{self, AppState, Constant, Documents, Hosts, Streams};
use super::jobs::Jobs;
use super::monitoring;
use super::openapi;
use anyhow::Context;
use axum::Router;
use std::io::Write;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::task::JoinHandle;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

/// How long open requests may take to end once the workers have stopped.
const DRAIN: Duration = Duration::from_millis(800);
/// How long the workers may take to hand back what they run.
const WORKERS: Duration = Duration::from_secs(2);

/// Serves until the process is told to stop.
///
/// # Errors
/// When the data directory cannot be used or the address cannot be bound.
pub async fn serve(config: Config) -> anyhow::Result<()> {
    let jobs = Jobs::open(config.clone()).await?;
    serve_jobs(config, jobs, |_| {}).await
}

/// The same with jobs that are open already; `started` is told where the service listens.
///
/// # Errors
/// When the address cannot be bound.
pub async fn serve_jobs(
    config: Config,
    jobs: Arc<Jobs>,
    started: impl FnOnce(SocketAddr),
) -> anyhow::Result<()> {
    let server = match Server::start(&config, jobs.clone()).await {
        Ok(server) => server,
        Err(error) => {
            jobs.shutdown().await;
            return Err(error);
        }
    };
    // Heard from before anybody is told that the service is there.
    let signals = StopSignals::listen();
    announce(format_args!(
        "trackloom listening on http://{}",
        server.address()
    ));
    started(server.address());
    signals.told_to_stop().await;
    tracing::info!("stopping");
    server.stop().await;
    Ok(())
}

/// Runs the jobs of a service that others ask, until the process is told to stop.
///
/// # Errors
/// When the database or the data directory cannot be used.
pub async fn work(config: Config) -> anyhow::Result<()> {
    let slots = config.slots;
    let jobs = Jobs::open(config).await?;
    let signals = StopSignals::listen();
    announce(format_args!("trackloom worker with {slots} slots"));
    signals.told_to_stop().await;
    tracing::info!("stopping");
    if timeout(WORKERS, jobs.shutdown()).await.is_err() {
        tracing::warn!("work did not stop in time; another process takes it up");
    }
    Ok(())
}

/// A service that answers at [`Server::address`] until [`Server::stop`].
pub struct Server {
    address: SocketAddr,
    jobs: Arc<Jobs>,
    stop: CancellationToken,
    serving: JoinHandle<()>,
}

impl Server {
    /// # Errors
    /// When the address cannot be bound, or metrics cannot be set up.
    pub async fn start(config: &Config, jobs: Arc<Jobs>) -> anyhow::Result<Server> {
        let application = http::wrap(
            http::application(state(config, jobs.clone())?),
            Hosts::new(&config.allowed_hosts, &config.allowed_origins),
        );
        Server::start_with(config, jobs, application).await
    }

    /// Serves any application, with the same life.
    ///
    /// # Errors
    /// When the address cannot be bound.
    pub async fn start_with(
        config: &Config,
        jobs: Arc<Jobs>,
        application: Router,
    ) -> anyhow::Result<Server> {
        let listener = TcpListener::bind(config.listen)
            .await
            .with_context(|| format!("cannot listen on {}", config.listen))?;
        let address = listener.local_addr()?;
        let reached_at = config.public_url.clone();
        let reached_at = reached_at.unwrap_or_else(|| format!("http://{address}"));
        jobs.sessions().are_reached_at(reached_at);
        let stop = CancellationToken::new();
        let serving = tokio::spawn(connections::serve(
            listener,
            application,
            config.connections.clone(),
            stop.clone(),
        ));
        Ok(Server {
            address,
            jobs,
            stop,
            serving,
        })
    }

    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// First the workers stop, while questions are still answered and `/readyz` says 503; event streams end with them.
    /// Then connections are closed.
    pub async fn stop(mut self) {
        if timeout(WORKERS, self.jobs.shutdown()).await.is_err() {
            tracing::warn!(
                "workers did not stop in time; their jobs are taken up at the next start"
            );
        }
        self.stop.cancel();
        if timeout(DRAIN, &mut self.serving).await.is_err() {
            self.serving.abort();
        }
    }
}

/// What handlers reach.
///
/// # Errors
/// When metrics cannot be set up.
pub fn state(config: &Config, jobs: Arc<Jobs>) -> anyhow::Result<AppState> {
    Ok(AppState {
        datasets: jobs.datasets().clone(),
        sessions: jobs.sessions().clone(),
        keys: jobs.keys().clone(),
        has_tls: config.has_tls(),
        jobs,
        max_upload_bytes: config.max_upload_bytes,
        metrics: monitoring::recorder()?,
        documents: Arc::new(Documents {
            v3_1: Constant::new(&openapi::document()),
            v3_0: Constant::new(&openapi::document_3_0()),
        }),
        streams: Streams::new(&config.connections),
    })
}

/// Who started the process may have stopped listening to it.
fn announce(text: std::fmt::Arguments) {
    if let Err(error) = writeln!(std::io::stdout().lock(), "{text}") {
        tracing::warn!(%error, "{text}");
    }
}

/// SIGTERM and SIGINT. Without signals the process can only be killed, which the storage survives.
struct StopSignals(Option<(Signal, Signal)>);

impl StopSignals {
    fn listen() -> Self {
        StopSignals(
            signal(SignalKind::terminate())
                .ok()
                .zip(signal(SignalKind::interrupt()).ok()),
        )
    }

    async fn told_to_stop(self) {
        let Some((mut terminate, mut interrupt)) = self.0 else {
            return std::future::pending().await;
        };
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
    }
}
