//! Who may ask: by which host, and from which site. Over plain sockets, since clients write these headers themselves.

use crate::helpers::{Api, id, long, small};
use reqwest::Method;
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// The answer to a request as it is written; `<own>` stands for the address of the server.
async fn raw(api: &Api, request: &str) -> String {
    let address = api.base.strip_prefix("http://").unwrap();
    let mut stream = TcpStream::connect(address).await.unwrap();
    stream
        .write_all(request.replace("<own>", address).as_bytes())
        .await
        .unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).await.unwrap();
    answer
}

/// Status, and code of the problem if it is one.
async fn asked(api: &Api, request: &str) -> (u16, String) {
    let answer = raw(api, request).await;
    let status = answer
        .split(' ')
        .nth(1)
        .unwrap_or_else(|| panic!("{answer}"))
        .parse()
        .unwrap();
    let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    let code = serde_json::from_str::<Value>(body)
        .ok()
        .and_then(|body| Some(body["code"].as_str()?.to_owned()));
    (status, code.unwrap_or_default())
}

async fn by_host(api: &Api, host: &str) -> (u16, String) {
    asked(
        api,
        &format!("GET /v1/jobs HTTP/1.1\r\n{host}Connection: close\r\n\r\n"),
    )
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn only_hosts_of_this_machine_and_allowed_ones_are_answered() {
    let api = Api::start_with(|config| config.allowed_hosts = vec!["Radar.example".into()]).await;
    for host in [
        "localhost",
        "LOCALHOST:1",
        "127.0.0.1:9",
        "[::1]:8080",
        "<own>",
        "radar.example",
        "radar.example.:443",
    ] {
        assert_eq!(
            by_host(&api, &format!("Host: {host}\r\n")).await,
            (200, String::new()),
            "{host}"
        );
    }
    for host in [
        "evil.example",
        "evil.example:80",
        "localhost.evil.example",
        "0.0.0.0",
        "127.0.0.2",
        "192.168.1.1",
        "[::2]",
        "example",
    ] {
        assert_eq!(
            by_host(&api, &format!("Host: {host}\r\n")).await,
            (403, "foreign_host".into()),
            "{host}"
        );
    }
    let answer = raw(
        &api,
        "GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n",
    )
    .await;
    let detail = "'evil.example' is not a host of this service; start it with --allow-host evil.example if it is meant to be one";
    assert!(answer.contains(detail), "the dashboard, too: {answer}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_names_one_host() {
    let api = Api::start().await;
    let malformed = (400, "malformed_request".to_owned());
    for host in [
        "",
        "Host: localhost\r\nHost: localhost\r\n",
        "Host:\r\n",
        "Host: me@localhost\r\n",
        "Host: localhost/x\r\n",
    ] {
        assert_eq!(by_host(&api, host).await, malformed, "{host}");
    }
    assert_eq!(
        asked(&api, "GET /v1/jobs HTTP/1.0\r\n\r\n").await,
        (200, String::new()),
        "HTTP/1.0 names none"
    );
    assert_eq!(
        asked(&api, "GET /v1/jobs HTTP/1.0\r\nHost: evil.example\r\n\r\n").await,
        (403, "foreign_host".into())
    );
    let absolute =
        "GET http://evil.example/v1/jobs HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    assert_eq!(
        asked(&api, absolute).await,
        (403, "foreign_host".into()),
        "the target goes before the header"
    );
    let own =
        "GET http://localhost:80/v1/jobs HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    assert_eq!(asked(&api, own).await, (200, String::new()));
}

#[tokio::test(flavor = "multi_thread")]
async fn pages_of_other_sites_change_nothing() {
    let api = Api::start().await;
    let job = api.post("/v1/jobs/simulate", &long()).await.ok(202);
    let cancel = format!("/v1/jobs/{}/cancel", id(&job));
    let path = format!("/v1/jobs/{}", id(&job));
    let refused = (403, "cross_site".to_owned());
    for headers in [
        "Origin: http://evil.example\r\nSec-Fetch-Site: cross-site\r\n",
        "Origin: http://localhost:1\r\nSec-Fetch-Site: same-site\r\n",
        "Origin: http://evil.example\r\n",
        "Origin: null\r\n",
        "Sec-Fetch-Site: cross-site\r\n",
    ] {
        for request in [
            format!("POST {cancel}"),
            format!("DELETE {path}"),
            format!("PATCH {path}"),
            "PUT /v1/jobs".to_owned(),
        ] {
            let request = format!(
                "{request} HTTP/1.1\r\nHost: <own>\r\n{headers}Content-Length: 0\r\nConnection: close\r\n\r\n"
            );
            assert_eq!(asked(&api, &request).await, refused, "{request}");
        }
        let read =
            format!("GET {path} HTTP/1.1\r\nHost: <own>\r\n{headers}Connection: close\r\n\r\n");
        assert_eq!(
            asked(&api, &read).await.0,
            200,
            "what only reads is kept from other pages by the browser"
        );
    }
    assert!(
        api.get(&path)
            .await
            .ok(200)
            .get("cancel_requested_at")
            .is_none()
    );
    for headers in [
        "Origin: http://<own>\r\n",
        "Sec-Fetch-Site: same-origin\r\nOrigin: https://proxy.example\r\n",
        "Sec-Fetch-Site: none\r\n",
        "",
    ] {
        let rerun = format!(
            "POST {path}/rerun HTTP/1.1\r\nHost: <own>\r\n{headers}Content-Length: 0\r\nConnection: close\r\n\r\n"
        );
        assert_eq!(asked(&api, &rerun).await.0, 202, "{headers}");
    }
}

/// A listed site may read and change, is told so before it sends, and gets no cookie; any other is refused as ever.
#[tokio::test(flavor = "multi_thread")]
async fn pages_of_listed_sites_use_the_service() {
    let listed = "https://radar.example.org";
    let api = Api::start_with(|config| config.allowed_origins = vec![listed.to_owned()]).await;
    let ask = async |method: Method, path: &str, origin: &str, more: &[(&str, &str)]| {
        let mut request = api.request(method, path).header("origin", origin);
        for (name, value) in more {
            request = request.header(*name, *value);
        }
        crate::helpers::send(request).await
    };
    let before = [
        ("access-control-request-method", "POST"),
        (
            "access-control-request-headers",
            "authorization,content-type",
        ),
    ];
    let told = ask(Method::OPTIONS, "/v1/jobs/simulate", listed, &before).await;
    assert_eq!(told.status, 204);
    assert_eq!(told.header("access-control-allow-origin"), listed);
    assert!(told.header("access-control-allow-methods").contains("POST"));
    assert!(
        told.header("access-control-allow-headers")
            .contains("authorization")
    );
    assert_eq!(told.headers.get("access-control-allow-credentials"), None);
    let body = long().to_string();
    let post = |origin| {
        let request = api.request(Method::POST, "/v1/jobs/simulate");
        let request = request.header("origin", origin);
        crate::helpers::send(
            request
                .header("content-type", "application/json")
                .body(body.clone()),
        )
    };
    let made = post(listed).await;
    assert_eq!(made.status, 202);
    assert_eq!(made.header("access-control-allow-origin"), listed);
    assert!(
        made.header("access-control-expose-headers")
            .contains("location")
    );
    for origin in ["https://evil.example", "http://radar.example.org", "null"] {
        let refused = post(origin).await;
        assert_eq!(refused.problem()["code"], "cross_site", "{origin}");
        let read = ask(Method::GET, "/v1/jobs", origin, &[]).await;
        assert_eq!(
            read.status, 200,
            "{origin}: a browser keeps it from the page"
        );
        assert_eq!(read.headers.get("access-control-allow-origin"), None);
        assert!(
            read.headers
                .get_all("vary")
                .iter()
                .any(|value| value == "origin")
        );
        let before = ask(Method::OPTIONS, "/v1/jobs/simulate", origin, &before).await;
        assert_eq!(before.headers.get("access-control-allow-origin"), None);
    }
    let unlisted = Api::start().await;
    let request = unlisted
        .request(Method::GET, "/v1/jobs")
        .header("origin", listed);
    let answer = crate::helpers::send(request).await;
    assert_eq!(answer.headers.get("access-control-allow-origin"), None);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_form_of_another_site_uploads_nothing() {
    let api = Api::start().await;
    let file =
        Part::bytes(b"time_s,truth_id,x_m,y_m\n0,t,1,2\n1,t,2,3\n".to_vec()).file_name("t.csv");
    let request = api
        .request(Method::POST, "/v1/datasets")
        .multipart(Form::new().part("file", file))
        .header("origin", "http://evil.example");
    assert_eq!(
        crate::helpers::send(request).await.problem()["code"],
        "cross_site"
    );
    assert_eq!(api.get("/v1/datasets?count=true").await.ok(200)["total"], 0);
    assert_eq!(
        api.post_with(
            "/v1/jobs/simulate",
            &small(),
            "origin",
            "http://evil.example"
        )
        .await
        .status,
        403
    );
    assert_eq!(
        api.get("/v1/jobs?count=true").await.ok(200)["total"],
        json!(0)
    );
}
