//! Taking connections and serving each of them, within limits: how many there are, how long one may be idle or send a
//! request, how slowly a body may come and an answer be read.

mod body;
mod pace;
mod stream;

pub use body::TooSlow;

use super::config::ConnectionLimits;
use super::types::Problem;
use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use axum::response::Response;
use axum::serve::Listener;
use body::{Answer, Paced};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::net::SocketAddr;
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use stream::Client;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tower::ServiceExt;

/// Connections above the limit that are told so at the same time; others are closed without a word.
const REFUSED: usize = 16;
/// How long a refused client is listened to, so that it sees the answer and not a reset.
const REFUSAL_TIME: Duration = Duration::from_secs(1);

/// Both ends of the connection that a request came by.
#[derive(Debug, Clone, Copy)]
pub struct Ends {
    pub client: SocketAddr,
    /// The address of this machine that was asked.
    pub own: SocketAddr,
}

/// Serves until `stop`; then nobody can connect any more, requests that run are answered, and their connections closed.
pub async fn serve(
    mut listener: TcpListener,
    application: Router,
    limits: ConnectionLimits,
    stop: CancellationToken,
) {
    let permits = Arc::new(Semaphore::new(limits.connections));
    let refusals = Arc::new(Semaphore::new(REFUSED));
    let limits = Arc::new(limits);
    let connections = TaskTracker::new();
    loop {
        let (stream, client) = tokio::select! {
            accepted = Listener::accept(&mut listener) => accepted,
            () = stop.cancelled() => break,
        };
        if let Ok(permit) = permits.clone().try_acquire_owned() {
            let connection = converse(
                stream,
                client,
                application.clone(),
                limits.clone(),
                stop.clone(),
            );
            connections.spawn(async move {
                connection.await;
                drop(permit);
            });
        } else if let Ok(permit) = refusals.clone().try_acquire_owned() {
            connections.spawn(async move {
                refuse(stream).await;
                drop(permit);
            });
        }
    }
    drop(listener);
    connections.close();
    connections.wait().await;
}

/// Answers the requests of one connection.
async fn converse(
    stream: TcpStream,
    client: SocketAddr,
    application: Router,
    limits: Arc<ConnectionLimits>,
    stop: CancellationToken,
) {
    // An answer is sent at once: headers and body go in two writes, and the second must not wait for the first to be acknowledged.
    let (Ok(()), Ok(own)) = (stream.set_nodelay(true), stream.local_addr()) else {
        return;
    };
    let requests = Arc::new(Requests::default());
    let io = TokioIo::new(Client::new(stream, requests.clone(), &limits));
    let ends = Ends { client, own };
    // Of hyper's own timer, which runs from one request to the end of the next one's headers; `Client` limits the headers alone.
    let idle_time = limits.idle_time;
    let service = service_fn(move |request| {
        respond(
            request,
            ends,
            application.clone(),
            limits.clone(),
            Busy::begin(&requests),
        )
    });
    let mut connection = pin!(
        http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(idle_time)
            .serve_connection(io, service)
    );
    tokio::select! {
        // A connection that breaks is the client's affair.
        _ = connection.as_mut() => return,
        () = stop.cancelled() => connection.as_mut().graceful_shutdown(),
    }
    let _ = connection.await;
}

async fn respond(
    request: Request<Incoming>,
    ends: Ends,
    application: Router,
    limits: Arc<ConnectionLimits>,
    busy: Busy,
) -> Result<Response<Answer>, Infallible> {
    let mut request = request.map(|body| Body::new(Paced::new(body, &limits)));
    request.extensions_mut().insert(ends);
    let response = application.oneshot(request).await?;
    Ok(response.map(|body| Answer::new(body, busy)))
}

/// The requests of one connection.
#[derive(Default)]
struct Requests {
    /// How many have been read so far.
    begun: AtomicUsize,
    /// How many are being answered.
    open: AtomicUsize,
}

/// A request is being answered while this lives.
struct Busy(Arc<Requests>);

impl Busy {
    fn begin(requests: &Arc<Requests>) -> Busy {
        requests.begun.fetch_add(1, Ordering::AcqRel);
        requests.open.fetch_add(1, Ordering::AcqRel);
        Busy(requests.clone())
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.open.fetch_sub(1, Ordering::AcqRel);
    }
}

/// Tells a client that there are too many, whatever it asks.
async fn refuse(mut stream: TcpStream) {
    let problem = Problem::new(
        "too_many_connections",
        "as many connections as the service takes are open",
    );
    let body = serde_json::to_string(&problem).unwrap_or_default();
    let head = "HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/problem+json\r\nretry-after: 5\r\nconnection: close";
    let answer = format!("{head}\r\ncontent-length: {}\r\n\r\n{body}", body.len());
    let tell = async {
        stream.write_all(answer.as_bytes()).await?;
        stream.shutdown().await?;
        let mut sent = [0; 4096];
        while stream.read(&mut sent).await? > 0 {}
        std::io::Result::Ok(())
    };
    // A client that is gone, or goes on sending, is told nothing more.
    let _ = timeout(REFUSAL_TIME, tell).await;
}
