//! Request headers that steer a job: `Prefer`, `Idempotency-Key`, `Last-Event-ID`. Two of them are still drafts; their
//! names stand here alone.

use crate::model::fault::Fault;
use crate::service::http::error::ApiError;
use axum::http::{HeaderMap, HeaderName, HeaderValue};
use axum::response::Response;
use std::time::Duration;

const PREFER: HeaderName = HeaderName::from_static("prefer");
const PREFERENCE_APPLIED: HeaderName = HeaderName::from_static("preference-applied");
const IDEMPOTENCY_KEY: HeaderName = HeaderName::from_static("idempotency-key");
const IDEMPOTENT_REPLAYED: HeaderName = HeaderName::from_static("idempotent-replayed");
const LAST_EVENT_ID: HeaderName = HeaderName::from_static("last-event-id");

/// Longest wait that is granted.
pub const MAX_WAIT_S: u64 = 30;
/// The largest number of an event; the databases have no unsigned ones.
pub const MAX_EVENT: u64 = i64::MAX as u64;
const MAX_KEY_LENGTH: usize = 255;

/// `Prefer: wait=n` in seconds, at most [`MAX_WAIT_S`]. Other preferences are not ours to judge (RFC 7240).
///
/// # Errors
/// A wait that is no number of seconds.
pub fn preferred_wait(headers: &HeaderMap) -> Result<Option<u64>, ApiError> {
    let values = headers
        .get_all(PREFER)
        .iter()
        .filter_map(|value| value.to_str().ok());
    let mut preferences = values
        .flat_map(|value| value.split([',', ';']))
        .map(|text| text.split_once('=').unwrap_or((text, "")));
    let Some((_, text)) = preferences.find(|(name, _)| name.trim().eq_ignore_ascii_case("wait"))
    else {
        return Ok(None);
    };
    let text = text.trim().trim_matches('"');
    match text.parse::<u64>() {
        Ok(seconds) => Ok(Some(seconds.min(MAX_WAIT_S))),
        Err(_) => Err(fault(
            &PREFER,
            &format!("'{text}' is not a number of seconds to wait"),
            "wait=n, a whole number of seconds",
        )),
    }
}

pub fn patience(wait_s: Option<u64>) -> Duration {
    Duration::from_secs(wait_s.unwrap_or(0))
}

/// Says which wait was granted.
pub fn note_wait(response: &mut Response, wait_s: Option<u64>) {
    if let Some(value) =
        wait_s.and_then(|wait_s| HeaderValue::from_str(&format!("wait={wait_s}")).ok())
    {
        response.headers_mut().insert(PREFERENCE_APPLIED, value);
    }
}

/// Says that the job is that of an earlier request with the same key.
pub fn note_replay(response: &mut Response) {
    response
        .headers_mut()
        .insert(IDEMPOTENT_REPLAYED, HeaderValue::from_static("true"));
}

/// # Errors
/// A key that is empty, too long, or not printable ASCII.
pub fn idempotency_key(headers: &HeaderMap) -> Result<Option<String>, ApiError> {
    let Some(value) = headers.get(IDEMPOTENCY_KEY) else {
        return Ok(None);
    };
    match value.to_str() {
        Ok(key) if (1..=MAX_KEY_LENGTH).contains(&key.len()) && !key.contains('\t') => {
            Ok(Some(key.to_owned()))
        }
        _ => Err(fault(
            &IDEMPOTENCY_KEY,
            "the key cannot be used",
            "1 to 255 printable ASCII characters",
        )),
    }
}

/// # Errors
/// A value that is no number.
pub fn last_event_id(headers: &HeaderMap) -> Result<Option<u64>, ApiError> {
    let Some(value) = headers.get(LAST_EVENT_ID) else {
        return Ok(None);
    };
    let number = value
        .to_str()
        .ok()
        .and_then(|text| text.parse().ok())
        .filter(|number| *number <= MAX_EVENT);
    number.map(Some).ok_or_else(|| {
        fault(
            &LAST_EVENT_ID,
            "the event's id is not a number",
            "the id of an event of this job",
        )
    })
}

fn fault(name: &HeaderName, detail: &str, allowed: &str) -> ApiError {
    ApiError::validation(vec![
        Fault::new(format!("/headers/{name}"), "unknown_value", detail).allowing(allowed),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wait(text: &'static str) -> Option<u64> {
        preferred_wait(&HeaderMap::from_iter([(
            PREFER,
            HeaderValue::from_static(text),
        )]))
        .unwrap()
    }

    #[test]
    fn a_wait_is_read_and_limited() {
        assert_eq!(wait("wait=10"), Some(10));
        assert_eq!(wait("respond-async, wait=100"), Some(30));
        assert_eq!(wait("respond-async"), None);
        assert_eq!(wait("WAIT = \"7\""), Some(7));
        assert_eq!(wait("waiting=soon"), None);
        for wrong in [
            "wait=soon",
            "wait",
            "wait=-1",
            "wait=1.5",
            "wait=99999999999999999999",
        ] {
            assert!(
                preferred_wait(&HeaderMap::from_iter([(
                    PREFER,
                    HeaderValue::from_static(wrong)
                )]))
                .is_err(),
                "{wrong}"
            );
        }
    }
}
