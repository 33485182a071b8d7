//! Blobs in an S3-compatible bucket, an object each, through local copies. Objects appear whole: a part that was sent of
//! a file that broke off is never seen.

use super::cache::Cache;
use super::directory::shard;
use super::{BucketUrl, hex};
use anyhow::{Context, anyhow, bail};
use object_store::aws::{AmazonS3Builder, AmazonS3ConfigKey};
use object_store::buffered::{BufReader, BufWriter};
use object_store::client::ClientConfigKey;
use object_store::{BackoffConfig, ObjectStore, ObjectStoreExt, RetryConfig};
use sha2::{Digest, Sha256};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::fs::File;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt};
use tokio::runtime::Handle;

/// Local copies take this much.
const CACHE_LIMIT_BYTES: u64 = 4 << 30;
/// Objects are sent and fetched in parts of this size, each tried again for itself.
const PART_BYTES: usize = 8 << 20;
/// Parts of one object that are on their way at the same time.
const PARTS_AT_ONCE: usize = 2;
/// How long a request is tried again while the store answers with errors or not at all; at the start it is known sooner.
const PATIENCE: Duration = Duration::from_secs(20);
const PATIENCE_AT_START: Duration = Duration::from_secs(5);
/// A request that is answered at all may take this many times as long: a part, on a slow line.
const SLOWNESS: u64 = 3;
/// The longest pause between two tries.
const BACKOFF_MAX: Duration = Duration::from_secs(2);

/// One bucket, or the part of it below a prefix. All calls but `open` block, outside the threads of the runtime.
#[derive(Debug)]
pub struct Bucket {
    url: BucketUrl,
    store: Arc<dyn ObjectStore>,
    cache: Cache,
    temporary: PathBuf,
    /// Names the blobs whose objects are being removed.
    removals: PathBuf,
    runtime: Handle,
}

impl Bucket {
    /// Reads keys and endpoint from the environment, and tries whether an object can be written, read and removed.
    pub async fn open(
        url: &BucketUrl,
        data_dir: &Path,
        temporary: &Path,
    ) -> anyhow::Result<Bucket> {
        let builder = AmazonS3Builder::from_env().with_bucket_name(url.bucket());
        try_out(builder.clone(), url)
            .await
            .with_context(|| format!("artefacts cannot be kept at {url}"))?;
        tracing::info!(bucket = %url, "artefacts are kept in a bucket");
        Ok(Bucket {
            url: url.clone(),
            store: store(builder, PATIENCE)?,
            cache: Cache::open(data_dir.join("cache"), CACHE_LIMIT_BYTES)?,
            temporary: temporary.to_owned(),
            removals: data_dir.join("removals"),
            runtime: Handle::current(),
        })
    }

    /// Writes the object, then keeps the file as its local copy.
    pub fn adopt(&self, received: &Path, sha256: &str) -> anyhow::Result<()> {
        let sent = self.runtime.block_on(self.send(received, sha256));
        sent.map_err(shortened)
            .with_context(|| format!("cannot write blob {sha256} to {}", self.url))?;
        self.cache.adopt(received, sha256)?;
        Ok(())
    }

    /// The local copy, fetched if it is not there. Nothing is at the path if there is no object.
    pub fn local(&self, sha256: &str) -> anyhow::Result<PathBuf> {
        if let Some(path) = self.cache.find(sha256) {
            return Ok(path);
        }
        // Removed with its name unless the cache has taken it over.
        let received = tempfile::NamedTempFile::new_in(&self.temporary)
            .context("cannot make a file for a blob")?
            .into_temp_path();
        let fetched = self.runtime.block_on(self.fetch(sha256, &received));
        match fetched
            .map_err(shortened)
            .with_context(|| format!("cannot read blob {sha256} from {}", self.url))?
        {
            None => {
                tracing::warn!(sha256, bucket = %self.url, "there is no such blob");
                Ok(self.cache.path(sha256))
            }
            Some(found) if found != sha256 => bail!(
                "blob {sha256} at {} is damaged: its content has the SHA-256 {found}",
                self.url
            ),
            Some(_) => self.cache.adopt(&received, sha256),
        }
    }

    pub fn left_over(&self) -> anyhow::Result<Vec<String>> {
        match fs::read_to_string(&self.removals) {
            Ok(text) => Ok(text.lines().map(str::to_owned).collect()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => {
                Err(error).with_context(|| format!("cannot read {}", self.removals.display()))
            }
        }
    }

    /// Their names are written down before, and struck out when all objects have gone.
    pub fn remove(&self, blobs: &[String]) -> anyhow::Result<()> {
        let noted = self.temporary.join("removals");
        fs::write(&noted, blobs.join("\n"))
            .and_then(|()| fs::rename(&noted, &self.removals))
            .context("cannot note what to remove")?;
        blobs
            .iter()
            .try_for_each(|sha256| self.cache.remove(sha256))?;
        match self.runtime.block_on(self.remove_objects(blobs)) {
            Ok(()) => {
                fs::remove_file(&self.removals).context("cannot strike out what has been removed")
            }
            Err(error) => {
                let error = shortened(error.into());
                tracing::warn!(bucket = %self.url, %error, "blobs were not removed; trying again with the next that are");
                Ok(())
            }
        }
    }

    async fn remove_objects(&self, blobs: &[String]) -> object_store::Result<()> {
        for sha256 in blobs {
            match self.store.delete(&self.place(sha256)).await {
                Ok(()) | Err(object_store::Error::NotFound { .. }) => {}
                // The others would fail the same way, and somebody waits.
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    async fn send(&self, received: &Path, sha256: &str) -> anyhow::Result<()> {
        let mut source = tokio::io::BufReader::with_capacity(1 << 20, File::open(received).await?);
        let writer = BufWriter::with_capacity(self.store.clone(), self.place(sha256), PART_BYTES);
        let mut writer = writer.with_max_concurrency(PARTS_AT_ONCE);
        if let Err(error) = tokio::io::copy_buf(&mut source, &mut writer).await {
            // The store may be out of reach; then it throws the parts away by its own rules.
            let _ = writer.abort().await;
            return Err(error.into());
        }
        Ok(writer.shutdown().await?)
    }

    /// Gives the SHA-256 of what was fetched; `None` if there is no object.
    async fn fetch(&self, sha256: &str, received: &Path) -> anyhow::Result<Option<String>> {
        let found = match self.store.head(&self.place(sha256)).await {
            Err(object_store::Error::NotFound { .. }) => return Ok(None),
            found => found?,
        };
        let mut source = BufReader::with_capacity(self.store.clone(), &found, PART_BYTES);
        let mut file = File::create(received).await?;
        let mut hash = Sha256::new();
        loop {
            let part = source.fill_buf().await?;
            let length = part.len();
            if length == 0 {
                break;
            }
            hash.update(part);
            file.write_all(part).await?;
            source.consume(length);
        }
        file.flush().await?;
        Ok(Some(hex(&hash.finalize())))
    }

    fn place(&self, sha256: &str) -> object_store::path::Path {
        self.url.key(&format!("{}/{sha256}", shard(sha256))).into()
    }
}

fn store(builder: AmazonS3Builder, patience: Duration) -> anyhow::Result<Arc<dyn ObjectStore>> {
    let backoff = BackoffConfig {
        max_backoff: BACKOFF_MAX,
        ..BackoffConfig::default()
    };
    // Time ends it, not a count: ten tries may be over within two seconds, and there is no time for a thousand.
    let retry = RetryConfig {
        backoff,
        max_retries: 1000,
        retry_timeout: patience,
    };
    let timeout = AmazonS3ConfigKey::Client(ClientConfigKey::Timeout);
    let store = builder
        .with_retry(retry)
        .with_config(
            timeout,
            format!("{} seconds", SLOWNESS * patience.as_secs()),
        )
        .build();
    Ok(Arc::new(
        store.context("the AWS_* variables cannot be used")?,
    ))
}

/// What happened and why; each error of the store tells all that is behind it but the last.
fn shortened(error: anyhow::Error) -> anyhow::Error {
    let (told, cause) = (error.to_string(), error.root_cause().to_string());
    if told.contains(&cause) {
        anyhow!(told)
    } else {
        anyhow!("{told}: {cause}")
    }
}

/// Writes, reads and removes an object.
async fn try_out(builder: AmazonS3Builder, url: &BucketUrl) -> anyhow::Result<()> {
    let has_key = builder
        .get_config_value(&AmazonS3ConfigKey::AccessKeyId)
        .is_some();
    let store = store(builder, PATIENCE_AT_START)?;
    let place = url.key(&format!("trial-{}", uuid::Uuid::now_v7())).into();
    let written_and_read = async {
        store.put(&place, "trackloom".into()).await?;
        store.get(&place).await?.bytes().await?;
        store.delete(&place).await
    };
    written_and_read.await.map_err(|error| {
        let reason = match &error {
            _ if !has_key => "AWS_ACCESS_KEY_ID is not set, and no other credentials were found",
            object_store::Error::NotFound { .. } => "there is no such bucket at the endpoint",
            object_store::Error::PermissionDenied { .. } | object_store::Error::Unauthenticated { .. } => {
                "the credentials do not allow to write, read and remove objects there"
            }
            _ => "the object store cannot be used; AWS_ENDPOINT, AWS_REGION and AWS_ALLOW_HTTP say where it is and how it is reached",
        };
        shortened(error.into()).context(reason)
    })
}
