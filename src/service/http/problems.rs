//! What problems mean: the pages that the `type` of a problem names, for programs as JSON and for people as HTML.

use super::conditional::{Constant, set};
use super::query::{NoParams, names};
use super::state::AppState;
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::types::{PROBLEMS, explanation};
use axum::extract::Path;
use axum::http::{HeaderMap, header};
use axum::response::{Html, IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(list_problem_types))
        .routes(routes!(get_problem_type))
}

/// What a `code` of a problem means.
#[derive(Serialize, ToSchema)]
struct ProblemType {
    code: &'static str,
    /// The HTTP status; of the problem of a failed job, the one that would fit.
    status: u16,
    title: &'static str,
    /// When it is told.
    cause: &'static str,
    /// What to do about it.
    remedy: &'static str,
}

#[derive(Serialize, ToSchema)]
struct ProblemTypeList {
    items: Vec<ProblemType>,
}

fn all() -> Vec<ProblemType> {
    let explained = |&(code, status, title): &(&'static str, u16, &'static str)| {
        let (cause, remedy) = explanation(code);
        ProblemType {
            code,
            status,
            title,
            cause,
            remedy,
        }
    };
    PROBLEMS.iter().map(explained).collect()
}

/// Which problems are there?
///
/// Every code with its status, its cause and what to do. A browser gets a page.
#[utoipa::path(get, path = "/problems", operation_id = "listProblemTypes", tag = "system",
    responses((status = 200, description = "Every problem.", body = ProblemTypeList)))]
async fn list_problem_types(_: NoParams, headers: HeaderMap) -> Response {
    let types = all();
    if wants_page(&headers) {
        page("Problems", &types)
    } else {
        as_json(&headers, &ProblemTypeList { items: types })
    }
}

/// What does a problem mean?
///
/// The page that the `type` of a problem names: its cause and what to do. A browser gets a page.
#[utoipa::path(get, path = "/problems/{code}", operation_id = "getProblemType", tag = "system",
    params(("code" = String, Path, description = "Code of the problem, such as `validation`.")),
    responses((status = 200, description = "Its meaning.", body = ProblemType)))]
async fn get_problem_type(Path(code): Path<String>, _: NoParams, headers: HeaderMap) -> ApiResult {
    let types = all();
    let Some(index) = types.iter().position(|known| known.code == code) else {
        let known = names(types.iter().map(|known| known.code));
        return Err(ApiError::new(
            "not_found",
            format!("there is no problem '{code}'; there are {known}"),
        ));
    };
    let found = &types[index];
    Ok(if wants_page(&headers) {
        page(found.title, std::slice::from_ref(found))
    } else {
        as_json(&headers, found)
    })
}

/// Browsers ask for HTML by name; programs do not.
fn wants_page(headers: &HeaderMap) -> bool {
    headers
        .get(header::ACCEPT)
        .and_then(|value| value.to_str().ok())
        .is_some_and(|accept| accept.contains("text/html"))
}

fn as_json(headers: &HeaderMap, value: &impl Serialize) -> Response {
    by_accept(Constant::new(value).answer(headers))
}

fn page(title: &str, types: &[ProblemType]) -> Response {
    let section = |found: &ProblemType| {
        let ProblemType {
            code,
            status,
            title,
            cause,
            remedy,
        } = found;
        format!(
            "<h2 id=\"{code}\"><a href=\"/problems/{code}\">{code}</a></h2>\n<p>{status} · {title}</p>\n<p>{cause}</p>\n<p>What to do: {remedy}</p>\n"
        )
    };
    let sections: String = types.iter().map(section).collect();
    let head = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title} · trackloom</title></head>"
    );
    let all = "<p><a href=\"/problems\">All problems</a> · <a href=\"/docs\">API</a></p>";
    by_accept(
        Html(format!(
            "{head}\n<body><main><h1>{title}</h1>\n{sections}{all}</main></body></html>\n"
        ))
        .into_response(),
    )
}

fn by_accept(mut response: Response) -> Response {
    set(&mut response, header::VARY, "accept");
    response
}
