//! The children that are ready: one a slot and one more for whoever asks, so that no work waits for a process to start.

use super::process::{Child, own_program, started};
use anyhow::Context;
use std::ops::{Deref, DerefMut};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use uuid::Uuid;

/// A start that failed is tried again so often, after a pause.
const START_TRIES: u32 = 5;
const START_PAUSE: Duration = Duration::from_secs(1);

/// Clones share everything.
#[derive(Clone)]
pub struct Children(Arc<Inner>);

struct Inner {
    program: PathBuf,
    memory_bytes: Option<u64>,
    /// So many are kept, be they idle or at work.
    wanted: usize,
    pool: Mutex<Pool>,
}

#[derive(Default)]
struct Pool {
    /// The one that was used last stands at the end.
    idle: Vec<Child>,
    /// On their way.
    starting: usize,
    lent: usize,
    is_closed: bool,
}

/// A child that somebody has; it is killed when this is dropped before it has answered.
pub struct Lent {
    child: Option<Child>,
    children: Children,
}

impl Children {
    /// Starts children for so many slots, and waits for the first. `program`: this one when absent.
    ///
    /// # Errors
    /// When it does not begin.
    pub async fn open(
        program: Option<PathBuf>,
        memory_bytes: Option<u64>,
        slots: usize,
    ) -> anyhow::Result<Children> {
        let program = program
            .map_or_else(own_program, Ok)
            .context("the program has no name")?;
        let first = started(&program, memory_bytes).await?;
        let pool = Mutex::new(Pool {
            idle: vec![first],
            ..Pool::default()
        });
        let children = Children(Arc::new(Inner {
            program,
            memory_bytes,
            wanted: slots + 1,
            pool,
        }));
        children.fill();
        Ok(children)
    }

    /// A child for some work: one that has the campaign loaded, if there is one.
    ///
    /// # Errors
    /// When none can be started.
    pub async fn take(&self, campaign: Option<Uuid>) -> anyhow::Result<Lent> {
        // Counts from now on.
        let mut lent = Lent {
            child: None,
            children: self.clone(),
        };
        self.lock().lent += 1;
        while let Some(mut child) = self.chosen(campaign) {
            let has_too_much =
                child.is_grown() && (campaign.is_none() || child.campaign() != campaign);
            if !has_too_much && !child.is_dead() {
                lent.child = Some(child);
                return Ok(lent);
            }
        }
        lent.child = Some(self.new_child().await?);
        Ok(lent)
    }

    /// Starts a child; where the system has no room for a process just now, tries again.
    async fn new_child(&self) -> anyhow::Result<Child> {
        let mut tries = 0;
        loop {
            match started(&self.0.program, self.0.memory_bytes).await {
                Err(error) if tries < START_TRIES => {
                    tracing::warn!(
                        error = format!("{error:#}"),
                        "a child did not begin; trying again"
                    );
                    tries += 1;
                    tokio::time::sleep(START_PAUSE).await;
                }
                started => return started,
            }
        }
    }

    fn chosen(&self, campaign: Option<Uuid>) -> Option<Child> {
        let mut pool = self.lock();
        let having = |wanted: Option<Uuid>| {
            pool.idle
                .iter()
                .rposition(|child| child.campaign() == wanted)
        };
        let place = having(campaign)
            .or_else(|| having(None))
            .or_else(|| pool.idle.len().checked_sub(1))?;
        Some(pool.idle.remove(place))
    }

    /// A campaign has ended: what was loaded for it is not asked for again.
    pub fn forget(&self, campaign: Uuid) {
        let is_full_of_it =
            |child: &mut Child| child.is_grown() && child.campaign() == Some(campaign);
        let ended: Vec<Child> = self.lock().idle.extract_if(.., is_full_of_it).collect();
        drop(ended);
        self.fill();
    }

    /// Ends the children that do nothing; those that work end with their work.
    pub fn close(&self) {
        let mut pool = self.lock();
        pool.is_closed = true;
        pool.idle.clear();
    }

    /// Starts children until there are as many as wanted.
    fn fill(&self) {
        let missing = {
            let mut pool = self.lock();
            let missing = if pool.is_closed {
                0
            } else {
                self.0
                    .wanted
                    .saturating_sub(pool.idle.len() + pool.starting + pool.lent)
            };
            pool.starting += missing;
            missing
        };
        for _ in 0..missing {
            let children = self.clone();
            let begun = Child::start(&self.0.program, self.0.memory_bytes, move |started| {
                children.add(started)
            });
            if let Err(error) = begun {
                self.add(Err(error.into()));
            }
        }
    }

    fn add(&self, started: anyhow::Result<Child>) {
        let mut pool = self.lock();
        pool.starting -= 1;
        match started {
            Ok(child) => self.put(&mut pool, child),
            // The next work that finds none tries again, and says what is wrong.
            Err(error) => tracing::error!(error = format!("{error:#}"), "a child did not begin"),
        }
    }

    /// Keeps a child that is ready, unless there are enough.
    fn put(&self, pool: &mut Pool, child: Child) {
        if !pool.is_closed && pool.idle.len() < self.0.wanted {
            pool.idle.push(child);
        }
    }

    fn lock(&self) -> MutexGuard<'_, Pool> {
        self.0.pool.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Lent {
    /// Gives back a child that has answered. One that keeps memory of nothing that is asked for again ends.
    pub fn give_back(mut self) {
        let child = self
            .child
            .take()
            .filter(|child| !child.is_grown() || child.campaign().is_some());
        if let Some(child) = child {
            self.children.put(&mut self.children.lock(), child);
        }
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        self.child = None;
        self.children.lock().lent -= 1;
        self.children.fill();
    }
}

impl Deref for Lent {
    type Target = Child;
    fn deref(&self) -> &Child {
        self.child
            .as_ref()
            .expect("it is there until it is given back")
    }
}

impl DerefMut for Lent {
    fn deref_mut(&mut self) -> &mut Child {
        self.child
            .as_mut()
            .expect("it is there until it is given back")
    }
}
