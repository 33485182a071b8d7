//! Whose requests are answered: those that name a host of ours, and of those that change something, those that no page of
//! another site has sent. So a web page can neither read through a name that it points at this machine (DNS rebinding)
//! nor send forms to it.

use super::body::drain;
use crate::service::connections::Ends;
use crate::service::http::error::ApiError;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, Version, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");
/// Always ours, with any port, besides the address that was connected to.
const OURS: [&str; 3] = ["localhost", "127.0.0.1", "[::1]"];

/// The hosts that are ours, and the origins of others whose pages may use the service.
#[derive(Debug, Clone)]
pub struct Hosts {
    names: Arc<[String]>,
    origins: Arc<[String]>,
}

impl Hosts {
    /// With more names than those of this machine.
    pub fn new(allowed: &[String], origins: &[String]) -> Self {
        let allowed = allowed.iter().map(|name| plain(name));
        let ours = OURS.into_iter().map(str::to_owned);
        Hosts {
            names: ours.chain(allowed).collect(),
            origins: origins.iter().map(|origin| plain(origin)).collect(),
        }
    }

    pub fn has_origins(&self) -> bool {
        !self.origins.is_empty()
    }

    /// Whether pages of this origin, such as `https://radar.example.org`, may use the service.
    pub fn allows_origin(&self, origin: &HeaderValue) -> bool {
        let origin = origin.to_str().map(plain);
        origin.is_ok_and(|origin| self.origins.contains(&origin))
    }

    /// Whether `host:port` is ours; `own` is the address that was connected to.
    fn allow(&self, host: &str, own: Option<SocketAddr>) -> bool {
        let host = plain(host);
        let address = host
            .trim_start_matches('[')
            .trim_end_matches(']')
            .parse::<IpAddr>()
            .ok();
        let is_own = address.is_some_and(|address| {
            own.is_some_and(|own| own.ip().to_canonical() == address.to_canonical())
        });
        is_own || self.names.contains(&host)
    }
}

/// A host name as it is compared.
fn plain(name: &str) -> String {
    name.trim_end_matches('.').to_ascii_lowercase()
}

/// Refuses what does not come from who may ask, and bodies that are encoded.
pub async fn guard(State(hosts): State<Hosts>, request: Request, next: Next) -> Response {
    let refused = check(&hosts, &request).err();
    match refused {
        None => next.run(request).await,
        Some(error) => {
            let (parts, body) = request.into_parts();
            drain(&parts.headers, body).await;
            error.into_response()
        }
    }
}

fn check(hosts: &Hosts, request: &Request) -> Result<(), ApiError> {
    let own = request.extensions().get::<Ends>().map(|ends| ends.own);
    let asked = host_header(request)?;
    let target = request
        .uri()
        .authority()
        .map(|authority| authority.as_str());
    for authority in asked.into_iter().chain(target) {
        let host = host_of(authority).ok_or_else(|| {
            malformed("the header Host is not a name or address with an optional port")
        })?;
        if !hosts.allow(host, own) {
            let detail = format!(
                "'{host}' is not a host of this service; start it with --allow-host {host} if it is meant to be one"
            );
            return Err(ApiError::new("foreign_host", detail));
        }
    }
    if !matches!(
        *request.method(),
        Method::GET | Method::HEAD | Method::OPTIONS | Method::TRACE
    ) {
        check_site(hosts, request.headers(), asked)?;
    }
    check_encoding(request.headers())
}

/// The only header `Host`; HTTP/1.0 does without.
fn host_header(request: &Request) -> Result<Option<&str>, ApiError> {
    let mut values = request.headers().get_all(header::HOST).iter();
    match (values.next(), values.next()) {
        (None, _) if request.version() < Version::HTTP_11 => Ok(None),
        (None, _) => Err(malformed("the header Host is missing")),
        (Some(_), Some(_)) => Err(malformed("the header Host is given more than once")),
        (Some(value), None) => match value.to_str() {
            Ok(text) => Ok(Some(text)),
            Err(_) => Err(malformed(
                "the header Host is not a name or address with an optional port",
            )),
        },
    }
}

fn malformed(detail: &str) -> ApiError {
    ApiError::new("malformed_request", detail)
}

/// The host of `host`, `host:port`, `[address]` or `[address]:port`.
fn host_of(authority: &str) -> Option<&str> {
    let end = if authority.starts_with('[') {
        authority.find(']')? + 1
    } else {
        authority.find(':').unwrap_or(authority.len())
    };
    let (host, port) = authority.split_at(end);
    let is_port = port.is_empty()
        || port
            .strip_prefix(':')
            .is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()));
    let is_host = |byte: u8| byte.is_ascii_alphanumeric() || b"-._[]:".contains(&byte);
    (is_port && !host.is_empty() && host.bytes().all(is_host)).then_some(host)
}

/// Browsers say from where a request comes: newer ones in `Sec-Fetch-Site`, on pages that are safe; all in `Origin`. What
/// says neither is no browser.
fn check_site(hosts: &Hosts, headers: &HeaderMap, host: Option<&str>) -> Result<(), ApiError> {
    let site = headers.get(SEC_FETCH_SITE);
    if site.is_some_and(|site| site == "same-origin" || site == "none") {
        return Ok(());
    }
    match headers.get(header::ORIGIN) {
        None if site.is_none() => Ok(()),
        Some(origin) if is_of_host(origin, host) || hosts.allows_origin(origin) => Ok(()),
        _ => Err(ApiError::new(
            "cross_site",
            "a page of another site sent the request; this service takes changes from its own pages alone",
        )),
    }
}

fn is_of_host(origin: &HeaderValue, host: Option<&str>) -> bool {
    let authority = origin
        .to_str()
        .ok()
        .and_then(|origin| origin.split_once("://"))
        .map(|(_, authority)| authority);
    authority.is_some_and(|authority| host.is_some_and(|host| host.eq_ignore_ascii_case(authority)))
}

/// No route takes a body that is encoded.
fn check_encoding(headers: &HeaderMap) -> Result<(), ApiError> {
    for value in headers.get_all(header::CONTENT_ENCODING) {
        let encoding = value.to_str().unwrap_or_default();
        if !encoding.trim().eq_ignore_ascii_case("identity") {
            return Err(compressed(&format!(
                "the body is encoded as '{encoding}'; send it as it is, without Content-Encoding"
            )));
        }
    }
    Ok(())
}

/// The refusal of a body that is compressed, which says what would be taken (RFC 7694).
pub fn compressed(detail: &str) -> ApiError {
    ApiError::new("unsupported_media_type", detail).with_header(
        header::ACCEPT_ENCODING,
        HeaderValue::from_static("identity"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_is_told_from_its_port() {
        for (authority, host) in [
            ("localhost", Some("localhost")),
            ("LOCALHOST:8080", Some("LOCALHOST")),
            ("127.0.0.1:", Some("127.0.0.1")),
            ("[::1]:80", Some("[::1]")),
            ("[fe80::1]", Some("[fe80::1]")),
            ("", None),
            (":80", None),
            ("a:b", None),
            ("[::1", None),
            ("[::1]x", None),
            ("user@localhost", None),
            ("localhost/a", None),
            ("localhost:80:80", None),
        ] {
            assert_eq!(host_of(authority), host, "{authority}");
        }
    }

    #[test]
    fn this_machine_the_address_asked_and_allowed_names_are_ours() {
        let hosts = Hosts::new(&["Radar.Example".to_owned()], &[]);
        let own = Some(SocketAddr::from(([192, 168, 1, 5], 8080)));
        for host in [
            "localhost",
            "LocalHost.",
            "127.0.0.1",
            "[::1]",
            "radar.example",
            "192.168.1.5",
            "[::ffff:192.168.1.5]",
        ] {
            assert!(hosts.allow(host, own), "{host}");
        }
        for host in [
            "evil.example",
            "localhost.evil.example",
            "192.168.1.6",
            "127.0.0.2",
            "[::2]",
            "example",
        ] {
            assert!(!hosts.allow(host, own), "{host}");
        }
    }
}
