//! One child, seen from the service. Three threads of the service attend to it: one that started it and hears it, one that speaks to it,
//! and one that hears its complaints.

use super::protocol::{self, Answer, Made, Message, Order};
use crate::service::child::report::ENGINE_VERSION;
use crate::service::types::Progress;
use anyhow::{Context, bail, ensure};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{ChildStderr, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc as blocking;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};
use tokio::sync::{mpsc, oneshot};
use uuid::Uuid;

/// The program of this process; Linux knows it also when its file has been replaced meanwhile.
///
/// # Errors
/// When the system does not tell.
pub(super) fn own_program() -> io::Result<PathBuf> {
    if cfg!(target_os = "linux") {
        Ok(PathBuf::from("/proc/self/exe"))
    } else {
        std::env::current_exe()
    }
}

/// Of the threads that attend to a child.
const STACK_BYTES: usize = 128 << 10;
/// What is kept of the complaints: the last ones say what it died of.
const COMPLAINT_BYTES: usize = 4096;
/// How a program that is refused memory aborts.
const ABORTED: i32 = 6;

/// How a child died.
#[derive(Debug, PartialEq, Eq)]
pub enum Death {
    /// It was refused memory.
    Memory,
    /// `signal: 9 (SIGKILL)`, and what it said last.
    Other(String),
}

/// What is heard of a child.
pub enum Heard {
    Progress(Progress),
    Done(Made),
    Died(Death),
}

/// A process that waits for work, or does it. It is killed when this is dropped.
pub struct Child {
    process: Arc<Mutex<std::process::Child>>,
    /// Frames on their way to the child.
    words: blocking::Sender<Vec<u8>>,
    answers: mpsc::UnboundedReceiver<Result<Answer, Death>>,
    /// The campaign that it has loaded.
    campaign: Option<Uuid>,
    is_grown: bool,
}

impl Child {
    /// Starts a child on a thread that lives as long as it, and tells when it is ready, or why it is not.
    ///
    /// # Errors
    /// When there is no such thread; then nothing is told.
    pub(super) fn start(
        program: &Path,
        memory_bytes: Option<u64>,
        ready: impl FnOnce(anyhow::Result<Child>) + Send + 'static,
    ) -> io::Result<()> {
        let mut command = Command::new(program);
        command
            .arg0("trackloom")
            .arg("child")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        if let Some(bytes) = memory_bytes {
            command.args(["--memory", &bytes.to_string()]);
        }
        // It needs no secrets. One heap for its two threads: each further one would take 64 MiB of addresses.
        command
            .env_clear()
            .env("MALLOC_ARENA_MAX", "1")
            .process_group(0);
        Builder::new()
            .name("child".to_owned())
            .stack_size(STACK_BYTES)
            .spawn(move || attend(command, ready))?;
        Ok(())
    }

    /// What it has loaded, for whoever chooses a child for a campaign.
    pub(super) fn campaign(&self) -> Option<Uuid> {
        self.campaign
    }

    /// Whether it keeps memory that is not of a campaign asked for.
    pub(super) fn is_grown(&self) -> bool {
        self.is_grown
    }

    /// Whether it died since it was used last.
    pub(super) fn is_dead(&mut self) -> bool {
        !matches!(
            self.answers.try_recv(),
            Err(mpsc::error::TryRecvError::Empty)
        )
    }

    /// Gives it something to do; [`Self::hear`] tells what comes of it.
    pub fn order(&mut self, order: Order) -> anyhow::Result<()> {
        self.campaign = order.campaign();
        self.say(&Message::Work(order))
    }

    /// Asks it to stop what it does.
    pub fn stop(&self) {
        if let Err(error) = self.say(&Message::Stop) {
            tracing::warn!(error = format!("{error:#}"), "a child was not told to stop");
        }
    }

    fn say(&self, message: &Message) -> anyhow::Result<()> {
        // Where the one who speaks to it is gone, its death is on the way.
        let _ = self.words.send(protocol::frame(message)?);
        Ok(())
    }

    /// The next that is heard of it.
    pub async fn hear(&mut self) -> Heard {
        loop {
            return match self.answers.recv().await {
                Some(Ok(Answer::Progress(progress))) => Heard::Progress(progress),
                Some(Ok(Answer::Done { made, is_grown })) => {
                    self.is_grown = is_grown;
                    Heard::Done(made)
                }
                Some(Ok(Answer::Ready { .. })) => continue,
                Some(Err(death)) => Heard::Died(death),
                None => Heard::Died(Death::Other("it had died before".to_owned())),
            };
        }
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        kill(&self.process);
    }
}

fn kill(process: &Mutex<std::process::Child>) {
    // It may be dead already.
    let _ = process
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .kill();
}

/// Starts the process and hears it until it dies. Linux kills a child when the thread that started it ends.
fn attend(mut command: Command, ready: impl FnOnce(anyhow::Result<Child>)) {
    let started = command
        .spawn()
        .with_context(|| format!("cannot start {}", command.get_program().display()));
    let mut process = match started {
        Ok(process) => process,
        Err(error) => return ready(Err(error)),
    };
    let (Some(input), Some(mut output), Some(complaints)) = (
        process.stdin.take(),
        process.stdout.take(),
        process.stderr.take(),
    ) else {
        return ready(Err(anyhow::anyhow!("a child has no pipes")));
    };
    let process = Arc::new(Mutex::new(process));
    let (sender, answers) = mpsc::unbounded_channel();
    let threads = speak(input).and_then(|words| Ok((words, listen(complaints)?)));
    let (words, complaints) = match threads {
        Ok(threads) => threads,
        Err(error) => {
            kill(&process);
            return ready(Err(error.into()));
        }
    };
    if let Err(error) = greet(&mut output) {
        let death = death_of(&process, complaints);
        return ready(Err(
            error.context(format!("a process for jobs did not begin: {death:?}"))
        ));
    }
    ready(Ok(Child {
        process: process.clone(),
        words,
        answers,
        campaign: None,
        is_grown: false,
    }));
    while let Ok(Some(answer)) = protocol::read::<Answer>(&mut output) {
        if sender.send(Ok(answer)).is_err() {
            break;
        }
    }
    // Whoever hears it may be gone.
    let _ = sender.send(Err(death_of(&process, complaints)));
}

/// The first word, which tells that it is the same program.
fn greet(output: &mut impl Read) -> anyhow::Result<()> {
    match protocol::read(output)? {
        Some(Answer::Ready { version }) => {
            ensure!(
                version == ENGINE_VERSION,
                "it is version {version}, and this is {ENGINE_VERSION}"
            );
            Ok(())
        }
        _ => bail!("it did not say that it is ready"),
    }
}

/// Passes words on; the end of the words is the end of the child's input, and so of the child.
fn speak(mut input: ChildStdin) -> io::Result<blocking::Sender<Vec<u8>>> {
    let (sender, words) = blocking::channel::<Vec<u8>>();
    Builder::new()
        .name("child-words".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            for word in words {
                if input.write_all(&word).is_err() {
                    break;
                }
            }
        })?;
    Ok(sender)
}

/// Logs the complaints line by line, and keeps the last ones.
fn listen(complaints: ChildStderr) -> io::Result<JoinHandle<String>> {
    Builder::new()
        .name("child-complaints".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            let (mut complaints, mut kept, mut line) =
                (BufReader::new(complaints), Vec::new(), Vec::new());
            while let Ok(1..) = (&mut complaints)
                .take(COMPLAINT_BYTES as u64)
                .read_until(b'\n', &mut line)
            {
                tracing::warn!(
                    text = String::from_utf8_lossy(&line).trim_end(),
                    "a child complains"
                );
                kept.append(&mut line);
                kept.drain(..kept.len().saturating_sub(COMPLAINT_BYTES));
            }
            String::from_utf8_lossy(&kept).into_owned()
        })
}

/// Waits for the end of a process that says nothing more.
fn death_of(process: &Mutex<std::process::Child>, complaints: JoinHandle<String>) -> Death {
    let mut process = process.lock().unwrap_or_else(PoisonError::into_inner);
    // What is dying already is not changed by this.
    let _ = process.kill();
    let ended = process.wait();
    let said = complaints.join().unwrap_or_default();
    match ended {
        Ok(status) => death(status, &said),
        Err(error) => Death::Other(error.to_string()),
    }
}

fn death(status: ExitStatus, said: &str) -> Death {
    let was_refused = said.contains("memory allocation of ") && said.contains(" bytes failed");
    if status.signal() == Some(ABORTED) && was_refused {
        Death::Memory
    } else {
        Death::Other(status.to_string())
    }
}

/// Starts a child and waits until it is ready.
pub(super) async fn started(program: &Path, memory_bytes: Option<u64>) -> anyhow::Result<Child> {
    let (sender, ready) = oneshot::channel();
    Child::start(program, memory_bytes, move |child| {
        // Nobody may wait any more; then the child ends with this.
        let _ = sender.send(child);
    })?;
    ready.await.context("the thread of a child ended")?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_abort_that_speaks_of_memory_is_one_of_memory() {
        let said = "memory allocation of 8589934592 bytes failed\n";
        assert_eq!(death(ExitStatus::from_raw(6), said), Death::Memory);
        assert_eq!(
            death(
                ExitStatus::from_raw(6),
                "thread caused non-unwinding panic. aborting."
            ),
            Death::Other("signal: 6 (SIGABRT)".into())
        );
        assert_eq!(
            death(ExitStatus::from_raw(9), said),
            Death::Other("signal: 9 (SIGKILL)".into())
        );
        assert_eq!(
            death(ExitStatus::from_raw(1 << 8), ""),
            Death::Other("exit status: 1".into())
        );
    }

    #[test]
    fn a_program_that_is_no_child_is_told_from_one() {
        let greeting = protocol::frame(&Answer::Ready {
            version: "0".into(),
        })
        .unwrap();
        let error = greet(&mut greeting.as_slice()).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("it is version 0, and this is {ENGINE_VERSION}")
        );
        assert!(greet(&mut "usage: something else".as_bytes()).is_err());
        assert!(greet(&mut [].as_slice()).is_err());
    }

    #[tokio::test]
    async fn a_program_that_cannot_be_started_is_named() {
        let error = started(Path::new("/nowhere/trackloom"), None)
            .await
            .err()
            .unwrap();
        assert_eq!(error.to_string(), "cannot start /nowhere/trackloom");
        let error = started(Path::new("/bin/true"), None).await.err().unwrap();
        assert!(
            error
                .to_string()
                .starts_with("a process for jobs did not begin"),
            "{error:#}"
        );
    }
}
