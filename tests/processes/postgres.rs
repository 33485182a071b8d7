//! A PostgreSQL for one test, from the distribution's packages, in a directory of its own.

use std::net::TcpListener;
use std::path::PathBuf;
use std::process::Command;

pub struct Postgres {
    directory: PathBuf,
    port: u16,
}

impl Postgres {
    /// A new one, running; `None`, with the reason printed, where PostgreSQL is not installed.
    pub fn start() -> Option<Postgres> {
        let is_there = |path: &str| std::path::Path::new(path).exists();
        if !is_there("/usr/lib/postgresql")
            && Command::new("postgres").arg("--version").output().is_err()
        {
            println!("skipped: PostgreSQL is not installed");
            return None;
        }
        let port = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        let postgres = Postgres {
            directory: std::env::temp_dir()
                .join(format!("trackloom-postgres-{}", uuid::Uuid::now_v7())),
            port,
        };
        postgres.up();
        Some(postgres)
    }

    pub fn url(&self) -> String {
        format!("postgres://trackloom@127.0.0.1:{}/postgres", self.port)
    }

    /// Starts it again.
    pub fn up(&self) {
        self.script("start");
    }

    /// Stops it as hard as a crash.
    pub fn down(&self) {
        self.script("stop");
    }

    /// Runs a statement.
    pub async fn execute(&self, statement: &'static str) {
        let pool = sqlx::PgPool::connect(&self.url()).await.unwrap();
        sqlx::query(statement).execute(&pool).await.unwrap();
        pool.close().await;
    }

    /// The number that a query gives.
    pub async fn number(&self, query: &'static str) -> i64 {
        let pool = sqlx::PgPool::connect(&self.url()).await.unwrap();
        let number = sqlx::query_scalar(query).fetch_one(&pool).await.unwrap();
        pool.close().await;
        number
    }

    fn script(&self, command: &str) {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/postgres.sh");
        let done = Command::new(script)
            .arg(command)
            .arg(&self.directory)
            .arg(self.port.to_string())
            .status()
            .unwrap();
        assert!(done.success(), "{command}");
    }
}

impl Drop for Postgres {
    fn drop(&mut self) {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/postgres.sh");
        let _ = Command::new(script)
            .arg("drop")
            .arg(&self.directory)
            .status();
    }
}
