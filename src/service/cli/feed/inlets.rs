//! Threads that wait for input: the standard input, datagrams, a connection that is made again when it ends.

use super::queue::{Chunk, Queue};
use anyhow::Context;
use std::io::{ErrorKind, Read};
use std::net::{TcpStream, ToSocketAddrs, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

const READ_BYTES: usize = 1 << 16;
/// How often a thread looks whether anybody still reads.
const LOOK: Duration = Duration::from_millis(200);
/// Between attempts to connect.
const PAUSE: Duration = Duration::from_secs(1);
const CONNECT: Duration = Duration::from_secs(5);

/// Reads the standard input to its end.
pub(super) fn stdin(queue: Queue) {
    std::thread::spawn(move || {
        let (mut input, mut buffer) = (std::io::stdin().lock(), vec![0; READ_BYTES]);
        loop {
            match input.read(&mut buffer) {
                Ok(0) => return queue.close(),
                Ok(count) => {
                    if !queue.put(Chunk::Bytes(buffer[..count].to_vec())) {
                        return;
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => {
                    let error = anyhow::Error::from(error);
                    return queue.fail(error.context("the standard input cannot be read"));
                }
            }
        }
    });
}

/// Datagrams that were lost, as far as that is seen.
pub(super) struct Datagrams {
    port: u16,
    lost: Arc<AtomicU64>,
}

impl Datagrams {
    /// For want of room here.
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    /// For want of room in the kernel, where it tells.
    pub fn lost_in_kernel(&self) -> u64 {
        let tables = ["/proc/net/udp", "/proc/net/udp6"].map(std::fs::read_to_string);
        let drops = |table: &String| drops_of(table, self.port);
        tables.iter().flatten().map(drops).sum()
    }
}

/// What the kernel dropped of the sockets of a port: the last column of its table.
fn drops_of(table: &str, port: u16) -> u64 {
    let own = format!(":{port:04X}");
    let rows = table.lines().skip(1).map(|row| row.split_whitespace());
    let of_port = rows.filter(|row| row.clone().nth(1).is_some_and(|at| at.ends_with(&own)));
    let drops = of_port.filter_map(|row| row.last()?.parse::<u64>().ok());
    drops.sum()
}

/// Listens for datagrams.
///
/// # Errors
/// An address that cannot be listened on.
pub(super) fn udp(address: &str, queue: Queue) -> anyhow::Result<Datagrams> {
    let socket =
        UdpSocket::bind(address).with_context(|| format!("cannot listen on udp://{address}"))?;
    socket.set_read_timeout(Some(LOOK))?;
    let port = socket.local_addr()?.port();
    eprintln!("listening on udp://{}", socket.local_addr()?);
    let lost = Arc::new(AtomicU64::new(0));
    let counted = lost.clone();
    std::thread::spawn(move || {
        let mut buffer = vec![0; READ_BYTES];
        while !queue.is_closed() {
            let Ok(count) = socket.recv(&mut buffer) else {
                continue;
            };
            match queue.put_now(Chunk::Datagram(buffer[..count].to_vec())) {
                Some(true) => {}
                Some(false) => drop(counted.fetch_add(1, Ordering::Relaxed)),
                None => return,
            }
        }
    });
    Ok(Datagrams { port, lost })
}

/// Reads from a server, and connects again when the connection ends.
pub(super) fn tcp(address: &str, queue: Queue) {
    let address = address.to_owned();
    std::thread::spawn(move || {
        let mut is_told = false;
        while !queue.is_closed() {
            match connect(&address) {
                Ok(stream) => {
                    eprintln!("connected to tcp://{address}");
                    is_told = false;
                    read_connection(stream, &queue);
                    queue.put(Chunk::Break);
                }
                Err(error) if !is_told => {
                    eprintln!("warning: no connection to tcp://{address}: {error}; it is tried on");
                    is_told = true;
                }
                Err(_) => {}
            }
            std::thread::sleep(PAUSE);
        }
    });
}

fn connect(address: &str) -> std::io::Result<TcpStream> {
    let mut last = ErrorKind::NotFound.into();
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => {
                stream.set_read_timeout(Some(LOOK))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

fn read_connection(mut stream: TcpStream, queue: &Queue) {
    let mut buffer = vec![0; READ_BYTES];
    while !queue.is_closed() {
        match stream.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => {
                if !queue.put(Chunk::Bytes(buffer[..count].to_vec())) {
                    return;
                }
            }
            Err(error) if is_passing(error.kind()) => {}
            Err(_) => return,
        }
    }
}

fn is_passing(kind: ErrorKind) -> bool {
    let passing = [
        ErrorKind::WouldBlock,
        ErrorKind::TimedOut,
        ErrorKind::Interrupted,
    ];
    passing.contains(&kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drops_are_those_of_the_port() {
        let table = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref pointer drops
  1: 0100007F:2A30 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 11 2 0000000000000000 17
  2: 00000000:2A31 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 12 2 0000000000000000 5
  3: 00000000:2A30 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 13 2 0000000000000000 3";
        assert_eq!((drops_of(table, 0x2a30), drops_of(table, 0x2a31)), (20, 5));
        assert_eq!(drops_of(table, 1), 0);
    }
}
