//! Opening the tables, in either database.

use anyhow::{Context, bail, ensure};
use sqlx::AnyPool;
use sqlx::any::{AnyConnectOptions, AnyPoolOptions};
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::{Any, AnyConnection, Connection, Executor, Transaction};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

static SQLITE_TABLES: Migrator = sqlx::migrate!("src/service/storage/migrations/sqlite");
static POSTGRES_TABLES: Migrator = sqlx::migrate!("src/service/storage/migrations/postgres");

/// SQLite connections that may read at the same time.
const READERS: u32 = 4;
/// Connections to PostgreSQL of one process.
const CONNECTIONS: u32 = 6;
/// Connections that may hold a guard at the same time; others wait.
const GUARDS: u32 = 4;
/// A database that does not answer is asked again until this has passed: longer than a restart takes.
const PATIENCE: Duration = Duration::from_secs(60);
/// The same at the start, when somebody waits for a word.
const FIRST_PATIENCE: Duration = Duration::from_secs(20);
/// The oldest PostgreSQL that is known to work.
const OLDEST_POSTGRES: i64 = 150_000;

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
    pub(super) read: AnyPool,
    pub(super) write: AnyPool,
    /// Whether other processes write as well.
    pub(super) is_shared: bool,
    guards: AnyPool,
}

/// While it lives, no other process removes unused files.
pub struct NoSweeping {
    _held: Option<Transaction<'static, Any>>,
}

/// While it lives, no other process keeps files, nor removes them.
pub struct Sweeping {
    _held: Option<Transaction<'static, Any>>,
}

impl Storage {
    /// Opens the tables, making them and bringing them up to date where needed.
    ///
    /// # Errors
    /// When the database cannot be reached or written, or was written by a newer version of this program.
    pub async fn open(database: &Database) -> anyhow::Result<Storage> {
        sqlx::any::install_default_drivers();
        match database {
            Database::Sqlite(path) => open_sqlite(path).await.with_context(|| format!("cannot use {}", path.display())),
            Database::Postgres(url) => {
                open_postgres(url).await.with_context(|| format!("cannot use the database {}", without_secrets(url)))
            }
        }
    }

    /// Begins a change. No other change, of this process or another, begins before it has ended.
    pub(super) async fn begin(&self) -> anyhow::Result<Transaction<'static, Any>> {
        let mut transaction = self.write.begin().await?;
        if self.is_shared {
            sqlx::query("LOCK TABLE one_writer IN EXCLUSIVE MODE").execute(&mut *transaction).await?;
        }
        Ok(transaction)
    }

    /// For whoever keeps files whose rows come later.
    pub async fn no_sweeping(&self) -> anyhow::Result<NoSweeping> {
        Ok(NoSweeping { _held: self.guard("LOCK TABLE sweeping IN SHARE MODE").await? })
    }

    /// For whoever removes files that no row has.
    pub async fn sweeping(&self) -> anyhow::Result<Sweeping> {
        Ok(Sweeping { _held: self.guard("LOCK TABLE sweeping IN EXCLUSIVE MODE").await? })
    }

    /// On connections of its own: whoever holds a guard needs another for the change itself.
    async fn guard(&self, statement: &'static str) -> anyhow::Result<Option<Transaction<'static, Any>>> {
        if !self.is_shared {
            return Ok(None);
        }
        let mut transaction = self.guards.begin().await?;
        sqlx::query(statement).execute(&mut *transaction).await?;
        Ok(Some(transaction))
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
        let set = sqlx::query_scalar("SELECT value FROM settings WHERE name = $1").bind(name).fetch_one(&mut *transaction).await?;
        transaction.commit().await?;
        Ok(set)
    }

    /// Whether the database answers.
    pub async fn check(&self) -> anyhow::Result<()> {
        sqlx::query("SELECT 1").execute(&self.read).await?;
        Ok(())
    }

    /// Writes nothing from now on; reading goes on until the last reader has gone.
    pub async fn close(&self) {
        self.write.close().await;
    }
}

async fn open_sqlite(path: &Path) -> anyhow::Result<Storage> {
    // FULL: what was answered is on the disk, also when the power fails.
    let setup = "PRAGMA busy_timeout = 30000; PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON";
    // A pool would try again and again where a file is not a database; one connection says so.
    let mut first = AnyConnection::connect_with(&sqlite_options(path, "rwc")?).await?;
    first.execute(sqlx::raw_sql(setup)).await?;
    first.close().await?;
    let write = pool(1, setup).connect_with(sqlite_options(path, "rwc")?).await?;
    migrate(&SQLITE_TABLES, &write).await?;
    let read = pool(READERS, "PRAGMA busy_timeout = 30000").connect_with(sqlite_options(path, "ro")?).await?;
    Ok(Storage { guards: read.clone(), read, write, is_shared: false })
}

fn sqlite_options(path: &Path, mode: &str) -> anyhow::Result<AnyConnectOptions> {
    let path = std::path::absolute(path)?;
    let path = path.to_str().context("the path is not UTF-8")?.replace('%', "%25").replace('?', "%3f").replace('#', "%23");
    Ok(AnyConnectOptions::from_str(&format!("sqlite://{path}?mode={mode}"))?)
}

async fn open_postgres(url: &str) -> anyhow::Result<Storage> {
    ensure!(
        url.starts_with("postgres://") || url.starts_with("postgresql://"),
        "it is not a URL such as postgres://user:password@host/database"
    );
    let pool = pool(CONNECTIONS, "").connect_lazy_with(AnyConnectOptions::from_str(url)?);
    wait_for(&pool).await?;
    let version: String = sqlx::query_scalar("SELECT current_setting('server_version_num')").fetch_one(&pool).await?;
    let number: i64 = version.parse().unwrap_or(0);
    ensure!(number >= OLDEST_POSTGRES, "it is PostgreSQL {}; {} or newer is needed", number / 10_000, OLDEST_POSTGRES / 10_000);
    migrate(&POSTGRES_TABLES, &pool).await?;
    let guards = self::pool(GUARDS, "").connect_lazy_with(AnyConnectOptions::from_str(url)?);
    Ok(Storage { read: pool.clone(), write: pool, is_shared: true, guards })
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

fn pool(size: u32, setup: &'static str) -> AnyPoolOptions {
    AnyPoolOptions::new().max_connections(size).acquire_timeout(PATIENCE).after_connect(move |connection, _| {
        Box::pin(async move {
            if !setup.is_empty() {
                (connection as &mut AnyConnection).execute(sqlx::raw_sql(setup)).await?;
            }
            Ok(())
        })
    })
}

async fn migrate(tables: &Migrator, pool: &AnyPool) -> anyhow::Result<()> {
    let known = tables.iter().map(|migration| migration.version).max().unwrap_or(0);
    tables.run(pool).await.map_err(|error| match error {
        MigrateError::VersionMissing(version) => anyhow::anyhow!(
            "its tables have version {version}, this program knows them up to version {known}: a newer trackloom has written it"
        ),
        MigrateError::VersionMismatch(version) => anyhow::anyhow!("its tables of version {version} are not those of trackloom"),
        other => anyhow::Error::from(other).context("its tables cannot be brought up to date"),
    })
}

/// The URL for a message.
fn without_secrets(url: &str) -> String {
    let Some((scheme, rest)) = url.split_once("://") else { return url.to_owned() };
    let place = rest.rsplit_once('@').map_or(rest, |(_, place)| place);
    format!("{scheme}://{}", place.split('?').next().unwrap_or(place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_shows_no_password() {
        assert_eq!(without_secrets("postgres://me:se@cret@host:5432/db?password=secret"), "postgres://host:5432/db");
        assert_eq!(without_secrets("postgres://host/db"), "postgres://host/db");
    }

    #[tokio::test]
    async fn a_path_of_any_letters_is_that_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a b%41?#ü.db");
        Storage::open(&Database::Sqlite(path.clone())).await.unwrap().close().await;
        assert!(path.exists());
    }

    #[tokio::test]
    async fn tables_of_a_newer_version_and_files_of_something_else_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("app.db");
        let storage = Storage::open(&Database::Sqlite(path.clone())).await.unwrap();
        sqlx::query(
            "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) VALUES (99, 'later', 1, x'00', 0)",
        )
        .execute(&storage.write)
        .await
        .unwrap();
        storage.close().await;
        let error = format!("{:#}", Storage::open(&Database::Sqlite(path)).await.unwrap_err());
        assert!(error.contains("version 99") && error.contains("up to version 3") && error.contains("newer trackloom"), "{error}");
        let other = directory.path().join("other.db");
        std::fs::write(&other, "this is not a database, whatever it is called; it is long enough to look like one").unwrap();
        let error = format!("{:#}", Storage::open(&Database::Sqlite(other)).await.unwrap_err());
        assert!(error.contains("other.db") && error.contains("not a database"), "{error}");
    }
}
