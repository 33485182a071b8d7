//! Whether the description of the interface says what every test of it is answered.

use reqwest::{Method, StatusCode};
use serde_json::Value;
use std::sync::LazyLock;

static DOCUMENT: LazyLock<Value> = LazyLock::new(trackloom::service::openapi::document);

/// Panics where a described operation answers what its description does not name: a status, or the code of a problem.
pub fn check(method: &Method, path: &str, status: StatusCode, body: &str) {
    let Some(operation) = operation(method, path) else {
        return;
    };
    // Not modified, and a part: what HTTP itself says of what 200 describes. 405 and 408 come before any operation.
    if matches!(status.as_u16(), 206 | 304 | 405 | 408) {
        return;
    }
    let described = &operation["responses"][status.as_str()];
    let told = format!("{method} {path} answers {status}, which is not described: {body}");
    assert!(described.is_object(), "{told}");
    if status.is_success() {
        return;
    }
    let problem: Value = serde_json::from_str(body).unwrap_or_default();
    let code = format!("`{}`", problem["code"].as_str().unwrap_or_default());
    let says = described["description"].as_str().unwrap_or_default();
    assert!(says.contains(&code), "{told}\n{says}");
}

/// The path without parameters goes first: `/v1/datasets/raw` is no dataset.
fn operation(method: &Method, path: &str) -> Option<&'static Value> {
    let paths = DOCUMENT["paths"].as_object()?;
    let exact = paths.get(path);
    let pattern = || paths.iter().find(|(pattern, _)| is_of(path, pattern));
    let item = exact.or_else(|| pattern().map(|(_, item)| item))?;
    item.get(method.as_str().to_lowercase())
}

fn is_of(path: &str, pattern: &str) -> bool {
    let (parts, wanted) = (path.split('/'), pattern.split('/'));
    parts.clone().count() == wanted.clone().count()
        && parts
            .zip(wanted)
            .all(|(part, wanted)| wanted.starts_with('{') || part == wanted)
}
