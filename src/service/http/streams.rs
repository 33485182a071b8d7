//! How many event streams are open: each one holds a connection for as long as its job lasts.

use crate::service::config::ConnectionLimits;
use crate::service::http::error::ApiError;
use axum::http::{HeaderName, HeaderValue, header};
use axum::response::sse::{self, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures::{Stream, StreamExt, stream};
use std::collections::HashMap;
use std::convert::Infallible;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

const KEEP_ALIVE: Duration = Duration::from_secs(15);
/// nginx passes on at once what says so.
const UNBUFFERED: HeaderName = HeaderName::from_static("x-accel-buffering");
/// What a browser waits before it connects again.
const RETRY: Duration = Duration::from_secs(2);

/// The streams that are open, by the address of the client.
#[derive(Debug, Clone)]
pub struct Streams(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    most: usize,
    most_of_a_client: usize,
    open: Mutex<HashMap<IpAddr, usize>>,
}

/// One open stream.
#[derive(Debug)]
pub struct OpenStream {
    streams: Streams,
    client: IpAddr,
}

impl Streams {
    pub fn new(limits: &ConnectionLimits) -> Self {
        Streams(Arc::new(Inner {
            most: limits.streams,
            most_of_a_client: limits.streams_per_client,
            open: Mutex::default(),
        }))
    }

    /// # Errors
    /// `too_many_streams`, of the client or of all.
    pub fn open(&self, client: IpAddr) -> Result<OpenStream, ApiError> {
        let mut open = self.locked();
        if open.values().sum::<usize>() >= self.0.most {
            return Err(too_many(&format!(
                "{} event streams are open, as many as the service has",
                self.0.most
            )));
        }
        let of_client = open.entry(client).or_default();
        if *of_client >= self.0.most_of_a_client {
            return Err(too_many(&format!(
                "{client} has {} event streams open, as many as one client may",
                self.0.most_of_a_client
            )));
        }
        *of_client += 1;
        Ok(OpenStream {
            streams: self.clone(),
            client,
        })
    }

    /// Nothing panics while it is locked.
    fn locked(&self) -> MutexGuard<'_, HashMap<IpAddr, usize>> {
        self.0.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for OpenStream {
    fn drop(&mut self) {
        let mut open = self.streams.locked();
        if let Some(count) = open.get_mut(&self.client) {
            *count -= 1;
            if *count == 0 {
                open.remove(&self.client);
            }
        }
    }
}

/// An event stream that counts as open for as long as somebody asks for the next event.
pub fn response<E: 'static>(
    open: OpenStream,
    events: impl Stream<Item = E> + Send + 'static,
    encode: fn(E) -> sse::Event,
) -> Response {
    let head = stream::iter([sse::Event::default().retry(RETRY)]);
    let events = head.chain(events.map(encode)).map(move |event| {
        let _ = &open;
        Ok::<_, Infallible>(event)
    });
    let mut response = Sse::new(events)
        .keep_alive(KeepAlive::new().interval(KEEP_ALIVE))
        .into_response();
    let headers = response.headers_mut();
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(UNBUFFERED, HeaderValue::from_static("no"));
    response
}

fn too_many(detail: &str) -> ApiError {
    ApiError::busy("too_many_streams", detail)
}
