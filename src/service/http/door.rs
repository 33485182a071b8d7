//! Who is let in: each operation needs nothing, any key, or a key that allows one action.

use super::body::drain;
use crate::service::http::error::ApiError;
use crate::service::keys::{Holder, Keys, Need, Refusal, need_of};
use axum::extract::{MatchedPath, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use utoipa::openapi::path::Operation;

/// The cookie by which a page keeps its key.
pub const COOKIE: &str = "trackloom_key";

/// What each route needs.
#[derive(Clone)]
pub struct Door {
    keys: Arc<Keys>,
    needs: Arc<HashMap<(Method, String), Need>>,
}

impl Door {
    pub fn new(keys: Arc<Keys>) -> Self {
        Door {
            keys,
            needs: Arc::new(
                operations()
                    .into_iter()
                    .map(|(route, _, need)| (route, need))
                    .collect(),
            ),
        }
    }

    fn need(&self, request: &Request) -> Need {
        let Some(path) = request.extensions().get::<MatchedPath>() else {
            // The files of the page tell nothing; what they ask for does.
            return Need::Nothing;
        };
        let method = match *request.method() {
            Method::HEAD => Method::GET,
            ref other => other.clone(),
        };
        let key = (method, path.as_str().to_owned());
        // Documents, and methods that no route takes.
        self.needs.get(&key).copied().unwrap_or(Need::AnyKey)
    }
}

/// By the name of the operation.
pub fn needs() -> BTreeMap<String, Need> {
    let named = operations().into_iter();
    named.map(|(_, name, need)| (name, need)).collect()
}

/// Method and path, name and need of all. From the document of the API: no route can be forgotten.
fn operations() -> Vec<((Method, String), String, Need)> {
    let mut found = Vec::new();
    let document = super::routes().into_openapi();
    for (path, item) in document.paths.paths {
        let operations = [
            (Method::GET, item.get),
            (Method::POST, item.post),
            (Method::PUT, item.put),
            (Method::PATCH, item.patch),
            (Method::DELETE, item.delete),
        ];
        for (method, operation) in operations {
            if let Some(operation) = operation {
                let need = need(&operation, method == Method::GET);
                let name = operation.operation_id.unwrap_or_default();
                found.push(((method, path.clone()), name, need));
            }
        }
    }
    found
}

fn need(operation: &Operation, only_reads: bool) -> Need {
    let name = operation.operation_id.as_deref().unwrap_or_default();
    let tags = operation.tags.as_deref().unwrap_or_default();
    need_of(name, tags.first().map_or("", String::as_str), only_reads)
}

/// Lets in who has a key for it. Whoever it is goes along with the request.
pub async fn ask(State(door): State<Door>, mut request: Request, next: Next) -> Response {
    let need = door.need(&request);
    let token = token(request.headers());
    let refused = match door.keys.holder(token.as_deref()).await {
        Ok(holder) if holder.may(need) => {
            if let Some(id) = holder.id {
                tracing::Span::current().record("key", tracing::field::display(id));
            }
            request.extensions_mut().insert(holder);
            None
        }
        Ok(holder) => Some(forbidden(&holder, need)),
        Err(_) if need == Need::Nothing => None,
        Err(refusal) => Some(refusal_of(refusal, token.is_some())),
    };
    match refused {
        None => next.run(request).await,
        Some(error) => {
            let (parts, body) = request.into_parts();
            drain(&parts.headers, body).await;
            error.into_response()
        }
    }
}

/// The key that a request has: in the header, else in the cookie.
fn token(headers: &HeaderMap) -> Option<String> {
    if let Some(value) = headers.get(header::AUTHORIZATION) {
        let (scheme, token) = value.to_str().ok()?.split_once(' ')?;
        return scheme
            .eq_ignore_ascii_case("bearer")
            .then(|| token.trim().to_owned());
    }
    let cookies = headers.get_all(header::COOKIE).iter();
    let texts = cookies.filter_map(|value| value.to_str().ok());
    let mut pairs = texts.flat_map(|text| text.split(';'));
    pairs.find_map(|pair| {
        let (name, value) = pair.trim().split_once('=')?;
        (name == COOKIE).then(|| value.to_owned())
    })
}

fn forbidden(holder: &Holder, need: Need) -> ApiError {
    let own: Vec<&str> = holder.actions.iter().map(|action| action.name()).collect();
    let wanted = match need {
        Need::Action(action) => action.name(),
        Need::Nothing | Need::AnyKey => "nothing",
    };
    let detail = format!(
        "this needs a key that allows '{wanted}'; the key allows {}",
        own.join(", ")
    );
    ApiError::new("forbidden", detail)
}

/// Why somebody was not let in, as an answer.
pub fn refusal_of(refusal: Refusal, is_given: bool) -> ApiError {
    let detail = match refusal {
        Refusal::Unknown if is_given => "the key is not one of this service",
        Refusal::Unknown => "the request has no key: send Authorization: Bearer and a key",
        Refusal::Expired => "the key has ended",
        Refusal::Revoked => "the key was revoked",
        Refusal::TooOften => {
            return ApiError::busy("too_many_requests", "the key asks more often than it may");
        }
        Refusal::Failed(error) => return crate::service::error::ServiceError::from(error).into(),
    };
    ApiError::new("unauthenticated", detail).with_header(
        header::WWW_AUTHENTICATE,
        HeaderValue::from_static("Bearer realm=\"trackloom\""),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::keys::Action;

    #[test]
    fn a_key_is_taken_from_the_header_before_the_cookie() {
        let of = |pairs: &[(header::HeaderName, &'static str)]| {
            let pairs = pairs.iter().cloned();
            token(&HeaderMap::from_iter(
                pairs.map(|(name, value)| (name, HeaderValue::from_static(value))),
            ))
        };
        assert_eq!(of(&[]), None);
        assert_eq!(
            of(&[(header::AUTHORIZATION, "bearer  a_b")]),
            Some("a_b".to_owned())
        );
        let cookie = (header::COOKIE, "x=1; trackloom_key=c; y=2");
        assert_eq!(of(std::slice::from_ref(&cookie)), Some("c".to_owned()));
        assert_eq!(
            of(&[cookie.clone(), (header::AUTHORIZATION, "Bearer a")]),
            Some("a".to_owned())
        );
        // Whoever sends another scheme means something else than the cookie.
        assert_eq!(of(&[cookie, (header::AUTHORIZATION, "Basic a")]), None);
        assert_eq!(of(&[(header::COOKIE, "not_trackloom_key=c")]), None);
    }

    #[test]
    fn what_changes_something_needs_more_than_reading() {
        for ((method, path), _, need) in operations() {
            let is_free = matches!(
                need,
                Need::Nothing | Need::AnyKey | Need::Action(Action::Read)
            );
            let is_open = ["/v1/validate", "/v1/login", "/v1/logout"].contains(&path.as_str());
            assert!(
                method == Method::GET || is_open || !is_free,
                "{method} {path}"
            );
        }
    }
}
