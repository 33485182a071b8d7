//! Datasets: rows about blobs.

use super::change::parse_id;
use super::filter::DatasetFilter;
use super::life::{ClaimedJob, NewArtifact};
use super::page::{Cursor, Page, push_search};
use super::statement::Statement;
use super::{Storage, from_micros, now, to_micros};
use crate::formats::FormatOptions;
use crate::model::dataset::{DatasetKind, DatasetSummary};
use crate::model::facts::RecordingFacts;
use crate::model::sensor::SensorSettings;
use crate::service::types::{
    DatasetInfo, DatasetLinks, DatasetOrigin, JobOrigin, JobOriginKind, UploadOrigin,
    UploadOriginKind,
};
use serde_json::{Map, Value, json};
use sqlx::any::AnyRow;
use sqlx::{AnyConnection, Row};
use std::collections::BTreeMap;
use uuid::Uuid;

/// A dataset about to be kept; its blob is already in place.
#[derive(Debug, Clone)]
pub struct NewDataset {
    pub name: String,
    pub format: String,
    pub bytes: u64,
    pub sha256: String,
    pub meta_sha256: String,
    /// The file's column name → the canonical one.
    pub columns: BTreeMap<String, String>,
    /// What its format was told.
    pub options: FormatOptions,
    pub summary: DatasetSummary,
    pub sensors: Vec<SensorSettings>,
    pub warnings: Vec<String>,
    pub origin_job_id: Option<Uuid>,
    pub file_name: Option<String>,
}

impl NewDataset {
    /// An artefact of a job that other jobs can use; it is canonical CSV.
    pub(super) fn from_job(job: &ClaimedJob, artifact: &NewArtifact) -> Option<Self> {
        let summary = artifact.dataset.clone()?;
        let maker = job
            .name
            .clone()
            .unwrap_or_else(|| format!("job {}", job.id));
        Some(NewDataset {
            name: format!("{} of {maker}", summary.kind.name()),
            format: "csv".to_owned(),
            bytes: artifact.bytes,
            sha256: artifact.sha256.clone(),
            meta_sha256: String::new(),
            columns: BTreeMap::new(),
            options: told_of(&summary),
            summary,
            sensors: artifact.sensors.clone(),
            warnings: Vec::new(),
            origin_job_id: Some(job.id),
            file_name: Some(artifact.name.clone()),
        })
    }
}

/// What the CSV of a job does not say of itself.
fn told_of(summary: &DatasetSummary) -> FormatOptions {
    let mut options = FormatOptions::default();
    options.add("origin", &summary.frame);
    let base = Some(summary.time_base).filter(|base| base.is_utc());
    options.add("time_base", &base);
    options
}

/// A dataset with what is needed to read its file again.
#[derive(Debug, Clone)]
pub struct StoredDataset {
    pub info: DatasetInfo,
    pub columns: BTreeMap<String, String>,
    /// What its format was told.
    pub options: FormatOptions,
    pub file_name: Option<String>,
    pub deleted: bool,
    /// Of detections; `None` of those that an earlier version kept.
    pub facts: Option<RecordingFacts>,
}

const COLUMNS: &str = "SELECT id, name, format, bytes, sha256, columns, format_options, summary, sensors, warnings, origin_job_id, file_name,
    created_at, CASE WHEN deleted_at IS NULL THEN 0 ELSE 1 END AS deleted FROM datasets WHERE ";

impl Storage {
    /// Keeps a dataset, or finds the upload that is the same; `true` when it is new.
    pub async fn add_dataset(&self, new: &NewDataset) -> anyhow::Result<(Uuid, bool)> {
        let mut transaction = self.begin().await?;
        let known: Option<String> = sqlx::query_scalar(
            "SELECT id FROM datasets WHERE sha256 = $1 AND meta_sha256 = $2 AND deleted_at IS NULL AND origin_job_id IS NULL",
        )
        .bind(&new.sha256)
        .bind(&new.meta_sha256)
        .fetch_optional(&mut *transaction)
        .await?;
        if let Some(id) = known {
            return Ok((parse_id(&id)?, false));
        }
        let id = insert_dataset(&mut transaction, new).await?;
        transaction.commit().await?;
        Ok((id, true))
    }

    pub async fn dataset(&self, id: Uuid) -> anyhow::Result<Option<StoredDataset>> {
        let mut query = Statement::new(COLUMNS);
        query.push("id = ").bind(id.to_string());
        query
            .query()
            .fetch_optional(&self.read)
            .await?
            .as_ref()
            .map(stored)
            .transpose()
    }

    pub async fn datasets(
        &self,
        filter: &DatasetFilter,
        after: Option<Cursor>,
    ) -> anyhow::Result<Page<DatasetInfo>> {
        let count = "SELECT count(*) FROM datasets WHERE ";
        let read = |row: &AnyRow| Ok(stored(row)?.info);
        let paging = (&filter.paging, after);
        self.page((COLUMNS, count), condition(filter), paging, read)
            .await
    }

    /// Deletes a dataset; gives the jobs that still need it instead if there are any.
    pub async fn delete_dataset(&self, id: Uuid) -> anyhow::Result<Vec<Uuid>> {
        let mut transaction = self.begin().await?;
        let users = active_users(&mut transaction, "dataset", id).await?;
        if users.is_empty() {
            sqlx::query("UPDATE datasets SET deleted_at = $1 WHERE id = $2")
                .bind(to_micros(now()))
                .bind(id.to_string())
                .execute(&mut *transaction)
                .await?;
            transaction.commit().await?;
        }
        Ok(users)
    }

    /// Writes what an earlier version did not know of a dataset.
    pub async fn note_summary(&self, id: Uuid, summary: &DatasetSummary) -> anyhow::Result<()> {
        sqlx::query("UPDATE datasets SET summary = $1 WHERE id = $2")
            .bind(serde_json::to_string(summary)?)
            .bind(id.to_string())
            .execute(&self.write)
            .await?;
        Ok(())
    }

    /// Whether a dataset or an artefact still has this content.
    pub async fn blob_is_used(&self, sha256: &str) -> anyhow::Result<bool> {
        let uses: i64 = sqlx::query_scalar(
            "SELECT (SELECT count(*) FROM datasets WHERE sha256 = $1 AND deleted_at IS NULL)
                  + (SELECT count(*) FROM artifacts WHERE sha256 = $1)",
        )
        .bind(sha256)
        .fetch_one(&self.write)
        .await?;
        Ok(uses > 0)
    }
}

/// Queued and running jobs that read this source.
pub(super) async fn active_users(
    connection: &mut AnyConnection,
    source_kind: &str,
    id: Uuid,
) -> anyhow::Result<Vec<Uuid>> {
    let rows = sqlx::query(
        "SELECT jobs.id FROM job_dependencies JOIN jobs ON jobs.id = job_id
         WHERE source_kind = $1 AND source_id = $2 AND state IN ('queued', 'running') ORDER BY created_at, jobs.id",
    )
    .bind(source_kind)
    .bind(id.to_string())
    .fetch_all(connection)
    .await?;
    rows.iter().map(|row| parse_id(row.try_get(0)?)).collect()
}

pub(super) async fn insert_dataset(
    connection: &mut AnyConnection,
    new: &NewDataset,
) -> anyhow::Result<Uuid> {
    let id = Uuid::now_v7();
    sqlx::query(
        "INSERT INTO datasets (id, name, kind, format, bytes, sha256, meta_sha256, columns, format_options, summary, sensors, warnings,
             origin_job_id, file_name, created_at) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15)",
    )
    .bind(id.to_string())
    .bind(&new.name)
    .bind(new.summary.kind.name())
    .bind(&new.format)
    .bind(i64::try_from(new.bytes)?)
    .bind(&new.sha256)
    .bind(&new.meta_sha256)
    .bind(serde_json::to_string(&new.columns)?)
    .bind(serde_json::to_string(&new.options)?)
    .bind(serde_json::to_string(&new.summary)?)
    .bind(serde_json::to_string(&new.sensors)?)
    .bind(serde_json::to_string(&new.warnings)?)
    .bind(new.origin_job_id.map(|id| id.to_string()))
    .bind(&new.file_name)
    .bind(to_micros(now()))
    .execute(connection)
    .await?;
    Ok(id)
}

fn condition(filter: &DatasetFilter) -> Statement {
    let mut query = Statement::new("deleted_at IS NULL");
    if !filter.kinds.is_empty() {
        query
            .push(" AND kind IN ")
            .bind_list(filter.kinds.iter().map(|kind| kind.name().to_owned()));
    }
    if let Some(q) = &filter.q {
        push_search(&mut query, q);
    }
    query
}

fn stored(row: &AnyRow) -> anyhow::Result<StoredDataset> {
    let id = parse_id(row.try_get("id")?)?;
    let summary: DatasetSummary = serde_json::from_str(row.try_get("summary")?)?;
    let sensors: Vec<SensorSettings> = serde_json::from_str(row.try_get("sensors")?)?;
    let file_name: Option<String> = row.try_get("file_name")?;
    let format: String = row.try_get("format")?;
    let columns: BTreeMap<String, String> = serde_json::from_str(row.try_get("columns")?)?;
    let options: FormatOptions = serde_json::from_str(row.try_get("format_options")?)?;
    let origin = match row.try_get::<Option<&str>, _>("origin_job_id")? {
        Some(job_id) => DatasetOrigin::Job(JobOrigin {
            kind: JobOriginKind::Job,
            job_id: parse_id(job_id)?,
        }),
        None => DatasetOrigin::Upload(UploadOrigin {
            kind: UploadOriginKind::Upload,
            file_name: file_name.clone(),
        }),
    };
    let reading = matches!(origin, DatasetOrigin::Upload(_))
        .then(|| reading(summary.kind, &format, &columns, &options, &sensors));
    let info = DatasetInfo {
        id,
        name: row.try_get("name")?,
        kind: summary.kind,
        format,
        bytes: row.try_get::<i64, _>("bytes")?.cast_unsigned(),
        sha256: row.try_get("sha256")?,
        sensor_ids: summary.sensor_ids,
        scans: summary.scans,
        rows: summary.rows,
        objects: summary.objects,
        start_s: summary.start_s,
        end_s: summary.end_s,
        first_bearing_deg: summary.first_bearing_deg,
        last_bearing_deg: summary.last_bearing_deg,
        reports: summary
            .facts
            .iter()
            .flat_map(|facts| &facts.sensors)
            .map(Into::into)
            .collect(),
        has_truth_id: summary.facts.as_ref().map(|facts| facts.origins_known),
        frame: summary.frame,
        time_base: summary.time_base,
        units: summary.units,
        reading,
        origin,
        warnings: serde_json::from_str(row.try_get("warnings")?)?,
        created_at: from_micros(row.try_get("created_at")?)?,
        sensors,
        links: DatasetLinks::of(id),
    };
    Ok(StoredDataset {
        info,
        columns,
        options,
        file_name,
        facts: summary.facts,
        deleted: row.try_get::<i64, _>("deleted")? != 0,
    })
}

/// What an upload said that was read so, but for its name.
fn reading(
    kind: DatasetKind,
    format: &str,
    columns: &BTreeMap<String, String>,
    options: &FormatOptions,
    sensors: &[SensorSettings],
) -> Map<String, Value> {
    let mut said = Map::new();
    said.insert("kind".to_owned(), json!(kind));
    said.insert("format".to_owned(), json!(format));
    if !columns.is_empty() {
        said.insert("columns".to_owned(), json!(columns));
    }
    said.extend(
        options
            .iter()
            .map(|(name, value)| (name.clone(), value.clone())),
    );
    if !sensors.is_empty() {
        said.insert("sensors".to_owned(), json!(sensors));
    }
    said
}
