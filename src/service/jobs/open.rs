//! Opening a data directory: what it needs is checked, then the workers and the upkeep start.

use super::campaign::Campaigns;
use super::control::Running;
use super::hub::Hub;
use super::recent::Recent;
use super::{Jobs, handler, listen, maintain};
use crate::service::child::{Children, Desk, IS_LIMITED, default_memory, size_text};
use crate::service::config::Config;
use crate::service::datasets::Datasets;
use crate::service::engine::Engine;
use crate::service::keys::Keys;
use crate::service::sessions::Sessions;
use crate::service::storage::blobs::Blobs;
use crate::service::storage::notices::Notices;
use crate::service::storage::room::Room;
use crate::service::storage::{Database, Storage};
use anyhow::{Context, bail, ensure};
use std::fs::{DirBuilder, File, TryLockError};
use std::os::unix::fs::DirBuilderExt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

/// Files that are checked at the same time, and looks at data that are taken at the same time.
const UPLOADS: usize = 2;
const LOOKS: usize = 2;

impl Jobs {
    /// Opens the data directory, takes up what an earlier process left, and starts the workers.
    ///
    /// # Errors
    /// When another process uses the directory, or it cannot be read or written.
    pub async fn open(config: Config) -> anyhow::Result<Arc<Jobs>> {
        let jobs = Arc::new(Jobs::open_only(config).await?);
        if let Some(url) = &jobs.config.database_url {
            let notices = Notices::listen(url)
                .await
                .context("cannot listen to the database")?;
            tokio::spawn(listen(notices, Arc::downgrade(&jobs), jobs.closing.clone()));
        } else {
            jobs.take_up().await.with_context(|| {
                format!(
                    "cannot use the tables in {}",
                    jobs.config.data_dir.display()
                )
            })?;
        }
        jobs.enqueue_ready(jobs.lock.is_none()).await?;
        jobs.engine.run(handler(Arc::downgrade(&jobs)));
        tokio::spawn(maintain(Arc::downgrade(&jobs), jobs.closing.clone()));
        Ok(jobs)
    }

    /// Everything open, nothing running.
    async fn open_only(config: Config) -> anyhow::Result<Jobs> {
        let directory = &config.data_dir;
        make_private(directory).with_context(|| format!("cannot make {}", directory.display()))?;
        let database = match &config.database_url {
            None => Database::Sqlite(directory.join("app.db")),
            Some(url) => Database::Postgres(url.clone()),
        };
        let lock = if config.database_url.is_none() {
            Some(lock(directory)?)
        } else {
            None
        };
        let slots = config.slots.max(1);
        let storage = Storage::open(&database).await?;
        let blobs = Blobs::open(directory, config.artifacts.as_ref(), lock.is_none()).await?;
        let place = blobs.identity();
        ensure!(
            storage.agree_on("artifacts", place).await? == place,
            "the files of this database are kept elsewhere: say --data with the directory that its server uses, which all must reach, \
             or --artifacts with its bucket"
        );
        let room = Room::open(
            directory,
            lock.as_ref().map(|lock| (lock, LOCK)),
            config.min_free,
            config.max_data_bytes,
        )?;
        let job_memory_bytes = job_memory_bytes(&config, slots);
        let children = Children::open(config.child_program.clone(), job_memory_bytes, slots).await;
        let children = Arc::new(children.context("no process for jobs can be started")?);
        let closing = CancellationToken::new();
        let desk = |places| Desk::new(children.clone(), places, job_memory_bytes, closing.clone());
        let looks = desk(LOOKS);
        let desks = (desk(UPLOADS), looks.clone());
        let datasets = Datasets::new(storage.clone(), blobs.clone(), desks, closing.clone());
        let datasets = Arc::new(datasets);
        let keys = Arc::new(Keys::new(config.master_key.clone(), storage.clone()));
        let sessions = Sessions::new(storage.clone(), datasets.clone(), closing.clone());
        Ok(Jobs {
            room,
            blobs,
            children,
            engine: Engine::open(&database, slots).await?,
            storage,
            hub: Hub::default(),
            recent: Recent::default(),
            running: Running::default(),
            campaigns: Campaigns::default(),
            slots: Arc::new(Semaphore::new(slots)),
            datasets,
            sessions,
            keys,
            looks,
            closing,
            must_requeue: AtomicBool::new(false),
            config: Config {
                slots,
                job_memory_bytes,
                ..config
            },
            lock,
        })
    }
}

/// What each of so many jobs may use, where the system can limit it.
fn job_memory_bytes(config: &Config, slots: usize) -> Option<u64> {
    let bytes = config
        .job_memory_bytes
        .or_else(|| default_memory(slots))
        .filter(|_| IS_LIMITED);
    match bytes {
        Some(bytes) => tracing::info!(slots, "a job may use {} of memory", size_text(bytes)),
        None => tracing::warn!(
            "this system does not limit the memory of a process: one job may take all there is"
        ),
    }
    bytes
}

/// The file that is locked while the directory is in use.
const LOCK: &str = "lock";

/// Makes the directory where it is missing, for nobody but its owner.
fn make_private(directory: &Path) -> std::io::Result<()> {
    DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(directory)
}

fn lock(directory: &Path) -> anyhow::Result<File> {
    let path = directory.join(LOCK);
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path)
        .with_context(|| format!("cannot open {}", path.display()))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            bail!("{} is in use by another trackloom", directory.display())
        }
        Err(TryLockError::Error(error)) => {
            Err(error).with_context(|| format!("cannot lock {}", path.display()))
        }
    }
}
