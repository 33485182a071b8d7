//! A child from inside: one thread listens, one works. The end of the input is the end of the process, whatever it works on.

use super::campaign::Kept;
use super::protocol::{self, Answer, Made, Message, Order};
use super::{limit, work};
use crate::experiment::JobKind;
use crate::service::child::Failure;
use crate::service::child::meter::Meter;
use crate::service::child::report::ENGINE_VERSION;
use anyhow::Context;
use std::io::{self, ErrorKind};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use tokio::signal::unix::{SignalKind, signal};

/// Of the thread that works. It is there from the start: a stack that grows into the limit of the memory dies without a word.
const STACK_BYTES: usize = 8 << 20;
/// A process that keeps this much, or this part of what it may use, after its work is not what it was.
const GROWTH_BYTES: u64 = 64 << 20;
const GROWTH_PART: u64 = 16;

/// One order, and the sign that it is not wanted any more.
type Ordered = (Order, Arc<AtomicBool>);

/// Works until the input ends. `memory_bytes`: what it may use beyond what it has at the start.
///
/// # Errors
/// When the memory cannot be limited, or what is said cannot be understood.
pub fn run(memory_bytes: Option<u64>) -> anyhow::Result<()> {
    limit::depend_on_parent().context("cannot be bound to the service")?;
    leave_signals_to_the_service()?;
    let (sender, orders) = channel::<Ordered>();
    let worker = std::thread::Builder::new()
        .name("work".to_owned())
        .stack_size(STACK_BYTES);
    let growth = memory_bytes.map_or(GROWTH_BYTES, |bytes| GROWTH_BYTES.min(bytes / GROWTH_PART));
    worker
        .spawn(move || work_off(&orders, growth))
        .context("cannot start a thread")?;
    if let Some(bytes) = memory_bytes {
        limit::limit_memory(bytes).context("cannot limit the memory")?;
    }
    say(&Answer::Ready {
        version: ENGINE_VERSION.to_owned(),
    });
    let (mut input, mut stop) = (io::stdin().lock(), Arc::new(AtomicBool::new(false)));
    loop {
        match protocol::read(&mut input).context("cannot understand the service")? {
            Some(Message::Work(order)) => {
                stop = Arc::default();
                sender
                    .send((order, stop.clone()))
                    .context("the thread that works is gone")?;
            }
            Some(Message::Stop) => stop.store(true, Ordering::Relaxed),
            // Threads that work are not waited for.
            None => exit(0),
        }
    }
}

/// Whoever stops a group of processes means the service, which tells its children in its own time.
fn leave_signals_to_the_service() -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    let _inside = runtime.enter();
    // A signal that was once listened to does nothing else, also when nobody listens any more.
    for kind in [
        SignalKind::terminate(),
        SignalKind::interrupt(),
        SignalKind::hangup(),
    ] {
        let _ = signal(kind)?;
    }
    Ok(())
}

fn work_off(orders: &Receiver<Ordered>, growth_bytes: u64) {
    let before = limit::used_bytes();
    let mut kept = Kept::default();
    for (order, stop) in orders {
        kept.only(order.campaign());
        let meter = |kind: JobKind| {
            Meter::new(kind, stop.clone(), |progress| {
                say(&Answer::Progress(progress))
            })
        };
        let made = catch_unwind(AssertUnwindSafe(|| work::work(order, &mut kept, meter)));
        let has_panicked = made.is_err();
        let made =
            made.unwrap_or_else(|_| Err(Failure::Internal(anyhow::anyhow!("the work panicked"))));
        let made = made.unwrap_or_else(told);
        let is_grown = has_panicked || limit::used_bytes() > before + growth_bytes;
        say(&Answer::Done { made, is_grown });
    }
}

/// A failure as it is told.
fn told(failure: Failure) -> Made {
    match failure {
        Failure::Stopped => Made::Stopped,
        Failure::Faults(faults) => Made::Faults(faults),
        Failure::Memory => Made::Memory,
        Failure::Internal(error) | Failure::Died(error) => {
            let is = |kind| {
                error
                    .chain()
                    .filter_map(|cause| cause.downcast_ref::<io::Error>())
                    .any(|error| error.kind() == kind)
            };
            if is(ErrorKind::OutOfMemory) {
                return Made::Memory;
            }
            Made::Internal {
                text: format!("{error:#}"),
                is_full: is(ErrorKind::StorageFull) || is(ErrorKind::QuotaExceeded),
            }
        }
    }
}

/// A child that nobody hears has nothing to live for.
fn say(answer: &Answer) {
    if protocol::write(&mut io::stdout().lock(), answer).is_err() {
        exit(1);
    }
}
