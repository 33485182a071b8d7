//! Datasets: receive, list, look into, hand out, delete.

use super::body::{content_length, drain};
use super::conditional::{self, created};
use super::extract::{Id, Question};
use super::query::{NoParams, Params, names};
use super::raw_upload;
use super::state::AppState;
use super::upload::{self, Upload};
use crate::formats::{WRITERS, Writer, writer_named};
use crate::model::dataset::DatasetKind as ModelKind;
use crate::registry::placed;
use crate::service::error::ServiceError;
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::storage::{DatasetFilter, Paging, Sort};
use crate::service::types::{DatasetInfo, DatasetPage};
use crate::service::views::preview;
use axum::Json;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Rows of a preview when the caller does not say, and at most.
const PREVIEW_ROWS: (u64, u64) = (20, 1000);

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(upload_dataset, list_datasets))
        .routes(routes!(upload_raw_dataset))
        .layer(DefaultBodyLimit::disable())
        .routes(routes!(get_dataset, delete_dataset))
        .routes(routes!(preview_dataset))
        .routes(routes!(download_dataset))
}

/// Upload a dataset
///
/// Two parts: `meta` (JSON, may be left out) and `file`. With `meta` first, its faults are told before the file is read.
/// The same content with the same meta gives the dataset that exists already, with status 200 instead of 201. With
/// `?dry_run=true` the file is only looked at: the answer, with status 200, is the schema `Inspection`. It says what the file holds and
/// what seems wrong, and nothing of it is kept.
#[utoipa::path(post, path = "/v1/datasets", operation_id = "uploadDataset", tag = "datasets",
    params(("dry_run" = Option<bool>, Query, description = "Only look at the file: the answer is an `Inspection`.")),
    responses(
        (status = 200, description = "The dataset that exists already; with `dry_run` an `Inspection`.", body = DatasetInfo),
        (status = 201, description = "The dataset, checked and kept.", body = DatasetInfo),
    ))]
async fn upload_dataset(
    State(app): State<AppState>,
    mut params: Params,
    request: Request,
) -> ApiResult {
    let is_dry = params.flag("dry_run");
    params.finish()?;
    let request = with_room(&app, request).await?;
    let upload = upload::receive(request, app.datasets.temp_dir(), app.max_upload_bytes).await?;
    take(&app, &upload, is_dry, ("/meta", "/file")).await
}

/// Upload a dataset as the body
///
/// The body is the file; what is known of it besides stands in the query, each member of `DatasetMeta` under its name. Checks
/// and answers are those of the upload in parts: with `?dry_run=true` the schema `Inspection`.
#[utoipa::path(post, path = "/v1/datasets/raw", operation_id = "uploadRawDataset", tag = "datasets",
    responses(
        (status = 200, description = "The dataset that exists already; with `dry_run` an `Inspection`.", body = DatasetInfo),
        (status = 201, description = "The dataset, checked and kept.", body = DatasetInfo),
    ))]
async fn upload_raw_dataset(
    State(app): State<AppState>,
    mut params: Params,
    request: Request,
) -> ApiResult {
    let is_dry = params.flag("dry_run");
    let request = with_room(&app, request).await?;
    let upload = raw_upload::receive(
        params,
        request,
        app.datasets.temp_dir(),
        app.max_upload_bytes,
    )
    .await?;
    take(&app, &upload, is_dry, ("/query", "")).await
}

/// The request, where there is room for its body; old jobs go for it.
async fn with_room(app: &AppState, request: Request) -> Result<Request, ApiError> {
    let bytes = content_length(request.headers()).unwrap_or(0);
    app.jobs.make_room(bytes).await?;
    match app.jobs.check_room(bytes) {
        Ok(()) => Ok(request),
        Err(error) => {
            let headers = request.headers().clone();
            drain(&headers, request.into_body()).await;
            Err(ServiceError::from(error).into())
        }
    }
}

/// Keeps the upload, or only looks at it.
async fn take(app: &AppState, upload: &Upload, is_dry: bool, places: (&str, &str)) -> ApiResult {
    if !is_dry {
        return keep(app, upload, places).await;
    }
    let found = app.datasets.inspect(&upload.file, &upload.meta).await;
    let found = found.map_err(|error| upload::repoint(error, places.0, places.1))?;
    Ok(Json(found).into_response())
}

/// 201 with the dataset, or 200 where it was there before; faults name the places of the meta and of the file.
async fn keep(app: &AppState, upload: &Upload, (meta, file): (&str, &str)) -> ApiResult {
    let added = app
        .datasets
        .add(upload.file.clone(), upload.meta.clone())
        .await;
    let (dataset, is_new) = added.map_err(|error| upload::repoint(error, meta, file))?;
    let status = if is_new {
        StatusCode::CREATED
    } else {
        StatusCode::OK
    };
    let location = dataset.links.self_path.clone();
    Ok(created(status, &location, dataset))
}

/// List datasets
///
/// Newest first. `next_cursor` of a page, given back as `cursor`, gets the next one; datasets added meanwhile move
/// nothing.
#[utoipa::path(get, path = "/v1/datasets", operation_id = "listDatasets", tag = "datasets",
    params(
        ("kind" = Option<String>, Query, description = "Kinds to list, separated by commas: detections, truth, tracks, bearing_time."),
        ("q" = Option<String>, Query, max_length = 200, description = "Part of the name, or the start of the id."),
        ("sort" = Option<String>, Query, min_length = 1, description = "`-created_at` (newest first) or `created_at`."),
        ("limit" = Option<u32>, Query, minimum = 1, maximum = 200, description = "Datasets of a page; 50 when absent."),
        ("cursor" = Option<String>, Query, min_length = 1, description = "Where the page before ended."),
        ("count" = Option<bool>, Query, description = "Count every match in `total`."),
    ),
    responses((status = 200, description = "One page.", body = DatasetPage)))]
async fn list_datasets(State(app): State<AppState>, mut params: Params) -> ApiResult {
    let kind = |name: &str| ModelKind::ALL.into_iter().find(|kind| kind.name() == name);
    let filter = DatasetFilter {
        kinds: params.list("kind", &names(ModelKind::ALL.map(ModelKind::name)), kind),
        q: params.text("q"),
        paging: paging(&mut params),
    };
    params.add(filter.faults());
    let next = params.next_page();
    params.finish()?;
    let page = app.datasets.list(filter).await?;
    Ok(with_next("/v1/datasets", &next, &page, &page.next_cursor))
}

/// Get a dataset
///
/// What it holds, where it came from, and what the reader had to say about it.
#[utoipa::path(get, path = "/v1/datasets/{id}", operation_id = "getDataset", tag = "datasets",
    params(("id" = uuid::Uuid, Path, description = "Identity of the dataset.")),
    responses((status = 200, description = "The dataset.", body = DatasetInfo)))]
async fn get_dataset(asked: Question) -> ApiResult {
    let (State(app), Id(id), _, headers) = asked;
    conditional::weakly_tagged(&headers, &app.datasets.get(id).await?)
}

/// Delete a dataset
///
/// Refused with `in_use` while a queued or running job needs it. Afterwards the dataset is gone (410).
#[utoipa::path(delete, path = "/v1/datasets/{id}", operation_id = "deleteDataset", tag = "datasets",
    params(("id" = uuid::Uuid, Path, description = "Identity of the dataset.")),
    responses((status = 204, description = "It is deleted.")))]
async fn delete_dataset(State(app): State<AppState>, Id(id): Id, _: NoParams) -> ApiResult {
    app.datasets.delete(id).await?;
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// Look into a dataset
///
/// The first rows in the canonical columns, as text.
#[utoipa::path(get, path = "/v1/datasets/{id}/preview", operation_id = "previewDataset", tag = "datasets",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the dataset."),
        ("limit" = Option<u32>, Query, minimum = 1, maximum = 1000, description = "Rows to show; 20 when absent."),
    ),
    responses((status = 200, description = "The first rows.", body = preview::Preview)))]
async fn preview_dataset(State(app): State<AppState>, Id(id): Id, mut params: Params) -> ApiResult {
    let rows = params
        .whole_number("limit", 1..=PREVIEW_ROWS.1)
        .unwrap_or(PREVIEW_ROWS.0);
    params.finish()?;
    Ok(Json(app.datasets.preview(id, rows as usize).await?).into_response())
}

/// Download a dataset
///
/// The bytes as they were uploaded, in the media type of their format. Ranges are served. With `format` the dataset is written anew in
/// that format; one that cannot hold it is refused, and the refusal names those that can.
#[utoipa::path(get, path = "/v1/datasets/{id}/content", operation_id = "downloadDataset", tag = "datasets",
    params(
        ("id" = uuid::Uuid, Path, description = "Identity of the dataset."),
        ("format" = Option<String>, Query, min_length = 1, description = "csv, json, geojson, trips, kml, czml, gpx, mot, parquet, arrow, stonesoup, stonesoup_polar or stonesoup_bearings."),
    ),
    responses((status = 200, description = "The file.", content_type = "application/octet-stream", body = super::state::FileContent)))]
async fn download_dataset(
    State(app): State<AppState>,
    Id(id): Id,
    mut params: Params,
    headers: HeaderMap,
) -> ApiResult {
    let writer = asked_writer(&mut params);
    params.finish()?;
    match writer {
        Some(writer) => written(&app, id, writer).await,
        None => conditional::stored(&headers, app.datasets.file(id).await?, true).await,
    }
}

/// The format that a dataset is to be written in.
pub(super) fn asked_writer(params: &mut Params) -> Option<&'static Writer> {
    let known = names(WRITERS.iter().map(|writer| writer.name));
    params.read("format", &known, writer_named)
}

/// The dataset in another format.
pub(super) async fn written(app: &AppState, id: uuid::Uuid, writer: &Writer) -> ApiResult {
    let written = app.datasets.written(id, writer).await;
    let written = written.map_err(|error| match error {
        ServiceError::Invalid(faults) => ApiError::validation(placed("/query", faults)),
        error => error.into(),
    })?;
    conditional::written(written).await
}

pub(super) fn paging(params: &mut Params) -> Paging {
    let sort = |text: &str| match text {
        "-created_at" => Some(Sort::NewestFirst),
        "created_at" => Some(Sort::OldestFirst),
        _ => None,
    };
    Paging {
        sort: params
            .read("sort", "-created_at, created_at", sort)
            .unwrap_or_default(),
        limit: params
            .whole_number("limit", 1..=200)
            .map_or(0, |limit| limit as u32),
        cursor: params.text("cursor"),
        count: params.flag("count"),
    }
}

/// A page, with `Link: <…>; rel="next"` where there is a next one.
pub(super) fn with_next(
    path: &str,
    query: &str,
    page: &impl Serialize,
    cursor: &Option<String>,
) -> Response {
    let mut response = Json(page).into_response();
    if let Some(cursor) = cursor {
        conditional::set(
            &mut response,
            axum::http::header::LINK,
            &format!("<{path}?{query}cursor={cursor}>; rel=\"next\""),
        );
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documents_name_every_format_that_is_written() {
        let document = crate::service::openapi::document().to_string();
        for writer in WRITERS {
            let is_named = [", ", "\"", " or "]
                .iter()
                .any(|before| document.contains(&format!("{before}{}", writer.name)));
            assert!(is_named, "{}", writer.name);
        }
    }
}
