//! What the path names.

use super::query::NoParams;
use super::state::AppState;
use crate::service::http::error::ApiError;
use axum::extract::{FromRequestParts, Path, State};
use axum::http::HeaderMap;
use axum::http::request::Parts;
use uuid::Uuid;

/// The `{id}` of a path. A text that is no id belongs to nothing.
pub struct Id(pub Uuid);

impl<S: Send + Sync> FromRequestParts<S> for Id {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        named(parts, state).await.map(|(id, _)| Id(id))
    }
}

/// A question about one thing: no parameters, and headers that may know the answer.
pub type Question = (State<AppState>, Id, NoParams, HeaderMap);

/// The `{id}` and `{name}` of a path.
pub struct IdAndName(pub Uuid, pub String);

impl<S: Send + Sync> FromRequestParts<S> for IdAndName {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        named(parts, state)
            .await
            .map(|(id, name)| IdAndName(id, name))
    }
}

async fn named<S: Send + Sync>(parts: &mut Parts, state: &S) -> Result<(Uuid, String), ApiError> {
    let Path(names) = Path::<Vec<String>>::from_request_parts(parts, state)
        .await
        .map_err(|_| ApiError::not_found("path"))?;
    let [id, rest @ ..] = names.as_slice() else {
        return Err(ApiError::not_found("path"));
    };
    // Only the hyphenated form in lower case is an id; anything else would be a second name of the same thing.
    let parsed = Uuid::try_parse(id)
        .ok()
        .filter(|parsed| parsed.to_string() == *id);
    let parsed = parsed
        .ok_or_else(|| ApiError::new("not_found", format!("'{id}' is not the id of anything")))?;
    Ok((parsed, rest.first().cloned().unwrap_or_default()))
}
