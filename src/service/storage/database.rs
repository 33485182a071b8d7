//! Opening the tables, in either database.

use super::migrations::{Migrations, POSTGRES_TABLES, SQLITE_TABLES};
use super::recall::{Changes, Recall};
use super::transaction::Change;
use anyhow::{Context, bail, ensure};
use sqlx::any::{AnyConnectOptions, AnyPoolOptions};
use sqlx::migrate::{MigrateError, Migration, MigrationType, Migrator};
use sqlx::{AnyConnection, AnyPool, Connection, Executor, SqlSafeStr};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;
use std::time::{Duration, Instant};
use uuid::Uuid;

/// SQLite connections that may read at the same time.
const READERS: u32 = 4;
/// Connections to PostgreSQL of one process: for requests that read, for changes, and for workers that read.
const REQUESTS: u32 = 4;
const CHANGES: u32 = 3;
const WORKERS: u32 = 2;
/// Connections that may hold a guard at the same time; others wait.
const GUARDS: u32 = 4;
/// Who makes a request is told soon that the database does not answer.
const PATIENCE: Duration = Duration::from_secs(3);
/// A file is always there; whoever waits for a connection to it waits for others who write, one after the other.
const TURN_PATIENCE: Duration = Duration::from_secs(20);
/// Work waits longer: than a restart takes.
const WORK_PATIENCE: Duration = Duration::from_secs(60);
/// The same at the start, when somebody waits for a word.
const FIRST_PATIENCE: Duration = Duration::from_secs(20);
/// The oldest PostgreSQL that is known to work.
const OLDEST_POSTGRES: i64 = 150_000;

/// What each connection to a SQLite file begins with. Somebody else may hold the file for a moment, such as a backup.
const SQLITE_SETUP: &str = "PRAGMA busy_timeout = 3000";
/// The log is written back by [`Storage::tidy`], so that no change waits for that, unless it has grown to 16 MB.
const SQLITE_WRITER: &str = "PRAGMA busy_timeout = 3000; PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 4000; PRAGMA foreign_keys = ON";
/// A request that reads for so long is given up by the server.
const POSTGRES_REQUEST: &str = "SET statement_timeout = '5s'";
/// Whoever stops in the midst of a change does not hold up the others.
const POSTGRES_CHANGE: &str = "SET idle_in_transaction_session_timeout = '10s'";

/// How safe a change is when it has been answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Durability {
    /// It is on the disk, also when the power fails.
    Kept,
    /// It outlives the process. When the power fails it may be lost, as if it had come a moment later; what was before it stays.
    Passing,
}

/// Where the tables are.
#[derive(Debug, Clone)]
pub enum Database {
    /// A file that one process uses.
    Sqlite(PathBuf),
    /// A URL; many processes share it.
    Postgres(String),
}

/// The tables.
#[derive(Debug, Clone)]
pub struct Storage {
    /// For requests, which end soon or not at all.
    pub(super) read: AnyPool,
    pub(super) write: AnyPool,
    /// For work that reads, which may take as long as it takes.
    pub(super) work: AnyPool,
    /// Whose notes are whose: the name of this process where several share the tables.
    pub(super) owner: String,
    /// Whether other processes write as well.
    pub(super) is_shared: bool,
    guards: AnyPool,
    changes: Changes,
    /// Absent where other processes write as well.
    pub(super) recall: Option<Arc<Recall>>,
}

/// While it lives, no other process removes unused files.
pub struct NoSweeping {
    _held: Option<Change>,
}

/// While it lives, no other process keeps files, nor removes them.
pub struct Sweeping {
    _held: Option<Change>,
}

impl Storage {
    /// Opens the tables, making them and bringing them up to date where needed.
    ///
    /// # Errors
    /// When the database cannot be reached or written, or was written by a newer version of this program.
    pub async fn open(database: &Database) -> anyhow::Result<Storage> {
        sqlx::any::install_default_drivers();
        match database {
            Database::Sqlite(path) => open_sqlite(path)
                .await
                .with_context(|| format!("cannot use {}", path.display())),
            Database::Postgres(url) => open_postgres(url)
                .await
                .with_context(|| format!("cannot use the database {}", without_secrets(url))),
        }
    }

    /// Begins a change. No other change, of this process or another, begins before it has ended.
    pub(super) async fn begin(&self) -> anyhow::Result<Change> {
        self.begin_with(Durability::Kept).await
    }

    pub(super) async fn begin_with(&self, durability: Durability) -> anyhow::Result<Change> {
        let statements = match (self.is_shared, durability) {
            (false, Durability::Kept) => "PRAGMA synchronous = FULL; BEGIN IMMEDIATE",
            (false, Durability::Passing) => "PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE",
            (true, Durability::Kept) => "BEGIN; LOCK TABLE one_writer IN EXCLUSIVE MODE",
            (true, Durability::Passing) => {
                "BEGIN; SET LOCAL synchronous_commit = off; LOCK TABLE one_writer IN EXCLUSIVE MODE"
            }
        };
        Ok(Change::begin(&self.write, statements, &self.changes).await?)
    }

    /// For whoever keeps files whose rows come later.
    pub async fn no_sweeping(&self) -> anyhow::Result<NoSweeping> {
        Ok(NoSweeping {
            _held: self
                .guard("BEGIN; LOCK TABLE sweeping IN SHARE MODE")
                .await?,
        })
    }

    /// For whoever removes files that no row has.
    pub async fn sweeping(&self) -> anyhow::Result<Sweeping> {
        Ok(Sweeping {
            _held: self
                .guard("BEGIN; LOCK TABLE sweeping IN EXCLUSIVE MODE")
                .await?,
        })
    }

    /// On connections of its own: whoever holds a guard needs another for the change itself.
    async fn guard(&self, statements: &'static str) -> anyhow::Result<Option<Change>> {
        if !self.is_shared {
            return Ok(None);
        }
        Ok(Some(
            Change::begin(&self.guards, statements, &self.changes).await?,
        ))
    }

    /// Sets what all processes have to agree on, unless one of them has done so; gives what is set.
    pub async fn agree_on(&self, name: &str, value: &str) -> anyhow::Result<String> {
        if !self.is_shared {
            return Ok(value.to_owned());
        }
        let mut transaction = self.begin().await?;
        sqlx::query("INSERT INTO settings (name, value) VALUES ($1, $2) ON CONFLICT DO NOTHING")
            .bind(name)
            .bind(value)
            .execute(&mut *transaction)
            .await?;
        let set = sqlx::query_scalar("SELECT value FROM settings WHERE name = $1")
            .bind(name)
            .fetch_one(&mut *transaction)
            .await?;
        transaction.commit().await?;
        Ok(set)
    }

    /// Whether other processes use the tables as well.
    pub fn is_shared(&self) -> bool {
        self.is_shared
    }

    /// Whether the database answers.
    pub async fn check(&self) -> anyhow::Result<()> {
        sqlx::query("SELECT 1").execute(&self.read).await?;
        Ok(())
    }

    /// Writes the log of a SQLite file back into it, as far as nobody reads there, while changes go on.
    pub async fn tidy(&self) -> anyhow::Result<()> {
        if !self.is_shared {
            sqlx::raw_sql("PRAGMA wal_checkpoint(PASSIVE)")
                .execute(&self.guards)
                .await?;
        }
        Ok(())
    }

    /// Writes nothing from now on; reading goes on until the last reader has gone. Then a SQLite file has everything in itself.
    pub async fn close(&self) {
        if !self.is_shared
            && let Err(error) =
                sqlx::raw_sql("PRAGMA busy_timeout = 200; PRAGMA wal_checkpoint(TRUNCATE)")
                    .execute(&self.write)
                    .await
        {
            tracing::warn!(%error, "the log of the tables was not written back; the next start does it");
        }
        self.write.close().await;
    }
}

async fn open_sqlite(path: &Path) -> anyhow::Result<Storage> {
    // A pool would try again and again where a file is not a database; one connection says so.
    let mut first = AnyConnection::connect_with(&sqlite_options(path, "rwc")?).await?;
    first.execute(sqlx::raw_sql(SQLITE_WRITER)).await?;
    first.close().await?;
    let write = pool(1, TURN_PATIENCE, SQLITE_WRITER)
        .connect_with(sqlite_options(path, "rwc")?)
        .await?;
    migrate(SQLITE_TABLES, &write).await?;
    let read = pool(READERS, TURN_PATIENCE, SQLITE_SETUP)
        .connect_with(sqlite_options(path, "ro")?)
        .await?;
    // What writes the log back needs another connection that may write, or changes would wait.
    let guards =
        pool(1, TURN_PATIENCE, SQLITE_SETUP).connect_lazy_with(sqlite_options(path, "rw")?);
    let changes = Changes::default();
    Ok(Storage {
        work: read.clone(),
        read,
        write,
        owner: String::new(),
        is_shared: false,
        guards,
        recall: Some(Arc::new(Recall::new(changes.clone()))),
        changes,
    })
}

fn sqlite_options(path: &Path, mode: &str) -> anyhow::Result<AnyConnectOptions> {
    let path = std::path::absolute(path)?;
    let path = path
        .to_str()
        .context("the path is not UTF-8")?
        .replace('%', "%25")
        .replace('?', "%3f")
        .replace('#', "%23");
    Ok(AnyConnectOptions::from_str(&format!(
        "sqlite://{path}?mode={mode}"
    ))?)
}

async fn open_postgres(url: &str) -> anyhow::Result<Storage> {
    ensure!(
        url.starts_with("postgres://") || url.starts_with("postgresql://"),
        "it is not a URL such as postgres://user:password@host/database"
    );
    let options = AnyConnectOptions::from_str(url)?;
    let work = pool(WORKERS, WORK_PATIENCE, "").connect_lazy_with(options.clone());
    wait_for(&work).await?;
    let version: String = sqlx::query_scalar("SELECT current_setting('server_version_num')")
        .fetch_one(&work)
        .await?;
    let number: i64 = version.parse().unwrap_or(0);
    ensure!(
        number >= OLDEST_POSTGRES,
        "it is PostgreSQL {}; {} or newer is needed",
        number / 10_000,
        OLDEST_POSTGRES / 10_000
    );
    migrate(POSTGRES_TABLES, &work).await?;
    let read = pool(REQUESTS, PATIENCE, POSTGRES_REQUEST).connect_lazy_with(options.clone());
    let write = pool(CHANGES, PATIENCE, POSTGRES_CHANGE).connect_lazy_with(options.clone());
    let guards = pool(GUARDS, PATIENCE, "").connect_lazy_with(options);
    Ok(Storage {
        read,
        write,
        work,
        owner: Uuid::now_v7().to_string(),
        is_shared: true,
        guards,
        changes: Changes::default(),
        recall: None,
    })
}

/// Waits until the database answers, for it may be starting as well.
async fn wait_for(pool: &AnyPool) -> anyhow::Result<()> {
    let since = Instant::now();
    loop {
        let left = FIRST_PATIENCE.saturating_sub(since.elapsed());
        let error = match tokio::time::timeout(left, pool.acquire()).await {
            Ok(Ok(_)) => return Ok(()),
            Ok(Err(error @ sqlx::Error::Database(_))) => return Err(error.into()),
            Ok(Err(error)) => error.to_string(),
            Err(_) => "nothing answers there".to_owned(),
        };
        if since.elapsed() >= FIRST_PATIENCE {
            bail!("{error}; tried for {} s", FIRST_PATIENCE.as_secs());
        }
        tracing::warn!(error, "the database does not answer; trying again");
        tokio::time::sleep(Duration::from_secs(1)).await;
    }
}

fn pool(size: u32, patience: Duration, setup: &'static str) -> AnyPoolOptions {
    AnyPoolOptions::new()
        .max_connections(size)
        .acquire_timeout(patience)
        .after_connect(move |connection, _| {
            Box::pin(async move {
                if !setup.is_empty() {
                    (connection as &mut AnyConnection)
                        .execute(sqlx::raw_sql(setup))
                        .await?;
                }
                Ok(())
            })
        })
}

async fn migrate(tables: &Migrations, pool: &AnyPool) -> anyhow::Result<()> {
    let known = tables
        .iter()
        .map(|(version, ..)| *version)
        .max()
        .unwrap_or(0);
    let migration = |&(version, description, sql): &(i64, &'static str, &'static str)| {
        Migration::new(
            version,
            description.into(),
            MigrationType::Simple,
            sql.into_sql_str(),
            false,
        )
    };
    Migrator::with_migrations(tables.iter().map(migration).collect()).run(pool).await.map_err(|error| match error {
        MigrateError::VersionMissing(version) => anyhow::anyhow!(
            "its tables have version {version}, this program knows them up to version {known}: a newer trackloom has written it"
        ),
        MigrateError::VersionMismatch(version) => anyhow::anyhow!("its tables of version {version} are not those of trackloom"),
        other => anyhow::Error::from(other).context("its tables cannot be brought up to date"),
    })
}

/// The URL for a message.
fn without_secrets(url: &str) -> String {
    let Some((scheme, rest)) = url.split_once("://") else {
        return url.to_owned();
    };
    let place = rest.rsplit_once('@').map_or(rest, |(_, place)| place);
    format!("{scheme}://{}", place.split('?').next().unwrap_or(place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_shows_no_password() {
        assert_eq!(
            without_secrets("postgres://me:se@cret@host:5432/db?password=secret"),
            "postgres://host:5432/db"
        );
        assert_eq!(without_secrets("postgres://host/db"), "postgres://host/db");
    }

    #[tokio::test]
    async fn a_path_of_any_letters_is_that_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a b%41?#ü.db");
        Storage::open(&Database::Sqlite(path.clone()))
            .await
            .unwrap()
            .close()
            .await;
        assert!(path.exists());
    }

    #[tokio::test]
    async fn the_axes_of_a_record_of_before_are_an_option_of_its_format() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("app.db");
        let options = sqlite_options(&path, "rwc").unwrap();
        sqlx::any::install_default_drivers();
        let former = pool(1, TURN_PATIENCE, "")
            .connect_with(options)
            .await
            .unwrap();
        migrate(&SQLITE_TABLES[..4], &former).await.unwrap();
        for (id, axes) in [("a", "null"), ("b", r#"{"time_step_s":2.0}"#)] {
            sqlx::query(
                "INSERT INTO datasets (id, name, kind, format, bytes, sha256, meta_sha256, columns, bearing_time, summary, sensors, warnings, created_at)
                 VALUES ($1, 'n', 'bearing_time', 'npy', 1, $1, 'm', '{}', $2, '{}', '[]', '[]', 0)",
            )
            .bind(id)
            .bind(axes)
            .execute(&former)
            .await
            .unwrap();
        }
        former.close().await;
        let storage = Storage::open(&Database::Sqlite(path)).await.unwrap();
        let options: Vec<String> =
            sqlx::query_scalar("SELECT format_options FROM datasets ORDER BY id")
                .fetch_all(&storage.read)
                .await
                .unwrap();
        assert_eq!(options, ["{}", r#"{"bearing_time":{"time_step_s":2.0}}"#]);
    }

    #[tokio::test]
    async fn tables_of_a_newer_version_and_files_of_something_else_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("app.db");
        let storage = Storage::open(&Database::Sqlite(path.clone()))
            .await
            .unwrap();
        sqlx::query(
            "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) VALUES (99, 'later', 1, x'00', 0)",
        )
        .execute(&storage.write)
        .await
        .unwrap();
        storage.close().await;
        let error = format!(
            "{:#}",
            Storage::open(&Database::Sqlite(path)).await.unwrap_err()
        );
        assert!(
            error.contains("version 99")
                && error.contains("up to version 10")
                && error.contains("newer trackloom"),
            "{error}"
        );
        let other = directory.path().join("other.db");
        std::fs::write(
            &other,
            "this is not a database, whatever it is called; it is long enough to look like one",
        )
        .unwrap();
        let error = format!(
            "{:#}",
            Storage::open(&Database::Sqlite(other)).await.unwrap_err()
        );
        assert!(
            error.contains("other.db") && error.contains("not a database"),
            "{error}"
        );
    }
}
