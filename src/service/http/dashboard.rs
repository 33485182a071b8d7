//! The dashboard: the files of its build, embedded in the program. Without them a plain page says what is missing.

use super::conditional;
use crate::service::storage::blobs::hex;
use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use axum::response::{Html, IntoResponse, Response};
use rust_embed::RustEmbed;

#[derive(RustEmbed)]
#[folder = "static/dist"]
#[allow_missing = true]
struct Files;

const INDEX: &str = "index.html";
/// The page for files of their own, with a place for the data of a job.
const REPORT: &str = "report.html";
/// Files with a hash in their name: another content has another name.
const HASHED: &str = "assets/";
/// Paths that never belong to the dashboard.
const API: [&str; 3] = ["/v1", "/problems", "/docs"];

const MISSING: &str = "<!doctype html>
<html lang=\"en\"><head><meta charset=\"utf-8\"><title>trackloom</title></head>
<body><main><h1>trackloom</h1>
<p>The service is running, but this program was built without its dashboard: there was no npm when it was compiled.
Install Node with npm and build again.</p>
<p>The API is complete without it: <a href=\"/docs\">documentation</a>, <a href=\"/v1/jobs\">jobs</a>,
<a href=\"/v1/datasets\">datasets</a>, <a href=\"/v1/presets\">presets</a>.</p>
</main></body></html>
";

/// A file of the dashboard, or its page for every path that a browser navigates to; the page reads the path itself.
pub fn answer(path: &str, headers: &HeaderMap) -> Option<Response> {
    if API.iter().any(|prefix| {
        path.strip_prefix(prefix)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
    }) {
        return None;
    }
    let name = path.trim_start_matches('/');
    file(name, headers).or_else(|| is_navigation(path, headers).then(|| page(headers)))
}

/// The page that shows one job as a file; `None` where the program was built without the dashboard.
pub fn report_template() -> Option<String> {
    let file = Files::get(REPORT)?;
    String::from_utf8(file.data.into_owned()).ok()
}

fn file(name: &str, headers: &HeaderMap) -> Option<Response> {
    let file = Files::get(name)?;
    let sha256 = hex(&file.metadata.sha256_hash());
    let bytes = Bytes::from(file.data.into_owned());
    let mut response = conditional::fixed(headers, file.metadata.mimetype(), bytes, &sha256);
    if name.starts_with(HASHED) {
        conditional::set(
            &mut response,
            header::CACHE_CONTROL,
            "public, max-age=31536000, immutable",
        );
    }
    Some(response)
}

/// Browsers ask for HTML by name when they navigate; programs do not.
fn is_navigation(path: &str, headers: &HeaderMap) -> bool {
    let accept = headers
        .get(header::ACCEPT)
        .and_then(|value| value.to_str().ok())
        .unwrap_or_default();
    path == "/" || accept.contains("text/html")
}

fn page(headers: &HeaderMap) -> Response {
    file(INDEX, headers).unwrap_or_else(|| Html(MISSING).into_response())
}
