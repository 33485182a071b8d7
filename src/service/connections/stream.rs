//! The bytes of one connection, with an end to waiting: for the headers of a request, and for a client to read.

use super::Requests;
use super::pace::Pace;
use crate::service::config::ConnectionLimits;
use std::io::{self, ErrorKind, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Sleep, sleep};

pub(super) struct Client {
    stream: TcpStream,
    /// What comes while none of them is being answered belongs to the headers of the next.
    requests: Arc<Requests>,
    header_time: Duration,
    headers: Option<Headers>,
    reader: Pace,
}

/// The headers of a request whose first byte has come.
struct Headers {
    /// How many requests came before.
    before: usize,
    until: Pin<Box<Sleep>>,
}

impl Client {
    pub fn new(stream: TcpStream, requests: Arc<Requests>, limits: &ConnectionLimits) -> Self {
        Client {
            stream,
            requests,
            header_time: limits.header_time,
            headers: None,
            reader: Pace::new(limits),
        }
    }

    /// Bytes have come.
    fn note_read(&mut self) {
        if self.requests.open.load(Ordering::Acquire) > 0 {
            return;
        }
        let before = self.requests.begun.load(Ordering::Acquire);
        if self
            .headers
            .as_ref()
            .is_none_or(|headers| headers.before != before)
        {
            self.headers = Some(Headers {
                before,
                until: Box::pin(sleep(self.header_time)),
            });
        }
    }

    fn wait_for_headers(&mut self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        let begun = self.requests.begun.load(Ordering::Acquire);
        match &mut self.headers {
            Some(headers) if headers.before == begun => headers
                .until
                .as_mut()
                .poll(context)
                .map(|()| Err(ErrorKind::TimedOut.into())),
            _ => {
                self.headers = None;
                Poll::Pending
            }
        }
    }

    fn written(
        &mut self,
        context: &mut Context<'_>,
        written: Poll<io::Result<usize>>,
    ) -> Poll<io::Result<usize>> {
        match written {
            Poll::Ready(Ok(bytes)) => {
                self.reader.note(bytes);
                Poll::Ready(Ok(bytes))
            }
            Poll::Pending if self.reader.is_too_slow(context) => {
                Poll::Ready(Err(ErrorKind::TimedOut.into()))
            }
            other => other,
        }
    }
}

impl AsyncRead for Client {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        if Pin::new(&mut self.stream)
            .poll_read(context, buffer)?
            .is_pending()
        {
            return self.wait_for_headers(context);
        }
        if buffer.filled().len() > before {
            self.note_read();
        }
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Client {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.written(context, written)
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(context, slices);
        self.written(context, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }
}
