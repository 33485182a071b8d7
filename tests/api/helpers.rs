//! A server to ask, and verbs to ask with.

use crate::documents;
use axum::Router;
use reqwest::header::{HeaderMap, HeaderName};
use reqwest::multipart::{Form, Part};
use reqwest::{Client, Method, RequestBuilder, StatusCode};
use serde_json::{Value, json};
use std::sync::Arc;
use tempfile::TempDir;
use trackloom::service::config::Config;
use trackloom::service::http::{self, Hosts};
use trackloom::service::jobs::Jobs;
use trackloom::service::server::{Server, state};

/// A running server; its directory goes with it.
pub struct Api {
    pub base: String,
    pub client: Client,
    pub jobs: Arc<Jobs>,
    server: Option<Server>,
    directory: TempDir,
}

/// What the server said.
pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub text: String,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_else(|error| panic!("{error}: {}", self.text))
    }

    pub fn header(&self, name: &str) -> &str {
        self.headers
            .get(name)
            .map_or("", |value| value.to_str().unwrap())
    }

    /// The body of a success.
    #[track_caller]
    pub fn ok(&self, status: u16) -> Value {
        assert_eq!(self.status.as_u16(), status, "{}", self.text);
        self.json()
    }

    /// The whole body of a refusal, but for what differs from request to request; that has to be there.
    #[track_caller]
    pub fn problem(&self) -> Value {
        assert_eq!(
            self.header("content-type"),
            "application/problem+json",
            "{}",
            self.text
        );
        let mut body = self.json();
        assert_eq!(body["status"], self.status.as_u16(), "{body}");
        let members = body.as_object_mut().unwrap();
        assert!(
            members
                .shift_remove("instance")
                .unwrap()
                .as_str()
                .unwrap()
                .starts_with('/')
        );
        assert_eq!(
            members.shift_remove("request_id").unwrap(),
            self.header("x-request-id")
        );
        body
    }
}

/// The whole body of a `validation` problem with these faults.
pub fn validation(detail: &str, errors: Value) -> Value {
    json!({
        "type": "/problems/validation", "title": "The request is not valid", "status": 422, "detail": detail, "code": "validation",
        "errors": errors
    })
}

/// The whole body of any other problem.
pub fn problem(code: &str, status: u16, title: &str, detail: &str) -> Value {
    json!({"type": format!("/problems/{code}"), "title": title, "status": status, "detail": detail, "code": code, "errors": []})
}

impl Api {
    /// Where the service keeps everything.
    pub fn data(&self) -> std::path::PathBuf {
        self.directory.path().join("data")
    }

    pub async fn start() -> Api {
        Api::start_with(|_| {}).await
    }

    pub async fn start_with(change: impl FnOnce(&mut Config)) -> Api {
        Api::start_wrapped(change, |application| application).await
    }

    /// With more routes inside the layers.
    pub async fn start_wrapped(
        change: impl FnOnce(&mut Config),
        extend: impl FnOnce(Router) -> Router,
    ) -> Api {
        let directory = tempfile::tempdir().unwrap();
        let mut config = Config::new(directory.path().join("data"));
        config.listen = ([127, 0, 0, 1], 0).into();
        config.child_program = Some(env!("CARGO_BIN_EXE_trackloom").into());
        change(&mut config);
        let jobs = Jobs::open(config.clone()).await.unwrap();
        let application = extend(http::application(state(&config, jobs.clone()).unwrap()));
        let application = http::wrap(
            application,
            Hosts::new(&config.allowed_hosts, &config.allowed_origins),
        );
        let server = Server::start_with(&config, jobs.clone(), application)
            .await
            .unwrap();
        Api {
            base: format!("http://{}", server.address()),
            client: Client::new(),
            jobs,
            server: Some(server),
            directory,
        }
    }

    pub async fn stop(&mut self) {
        self.server.take().unwrap().stop().await;
    }

    pub fn request(&self, method: Method, path: &str) -> RequestBuilder {
        self.client.request(method, format!("{}{path}", self.base))
    }

    pub async fn get(&self, path: &str) -> Answer {
        send(self.request(Method::GET, path)).await
    }

    pub async fn get_with(&self, path: &str, name: &'static str, value: &str) -> Answer {
        send(
            self.request(Method::GET, path)
                .header(HeaderName::from_static(name), value),
        )
        .await
    }

    pub async fn post(&self, path: &str, body: &Value) -> Answer {
        send(self.request(Method::POST, path).json(body)).await
    }

    pub async fn post_with(
        &self,
        path: &str,
        body: &Value,
        name: &'static str,
        value: &str,
    ) -> Answer {
        send(
            self.request(Method::POST, path)
                .json(body)
                .header(HeaderName::from_static(name), value),
        )
        .await
    }

    pub async fn delete(&self, path: &str) -> Answer {
        send(self.request(Method::DELETE, path)).await
    }

    /// Posts a job and waits for its end.
    pub async fn run(&self, kind: &str, body: &Value) -> Value {
        let mut job = self
            .post_with(&format!("/v1/jobs/{kind}"), body, "prefer", "wait=30")
            .await
            .json();
        for _ in 0..10 {
            if job["finished_at"].is_string() {
                return job;
            }
            let id = job["id"]
                .as_str()
                .unwrap_or_else(|| panic!("no job: {job}"))
                .to_owned();
            self.jobs
                .wait(id.parse().unwrap(), std::time::Duration::from_secs(30))
                .await
                .unwrap();
            job = self.get(&format!("/v1/jobs/{id}")).await.json();
        }
        panic!("the job does not end: {job}")
    }

    /// Uploads a file with its meta.
    pub async fn upload(&self, meta: &Value, content: &str) -> Answer {
        let file = Part::bytes(content.as_bytes().to_vec()).file_name("file.csv");
        self.upload_form(
            Form::new()
                .part("meta", Part::text(meta.to_string()))
                .part("file", file),
        )
        .await
    }

    pub async fn upload_form(&self, form: Form) -> Answer {
        send(self.request(Method::POST, "/v1/datasets").multipart(form)).await
    }

    /// Id of a dataset with this content.
    pub async fn dataset(&self, content: &str) -> String {
        self.upload(&json!({}), content).await.ok(201)["id"]
            .as_str()
            .unwrap()
            .to_owned()
    }
}

pub async fn send(request: RequestBuilder) -> Answer {
    let (client, request) = request.build_split();
    let request = request.unwrap();
    let (method, path) = (request.method().clone(), request.url().path().to_owned());
    let response = client.execute(request).await.unwrap();
    let (status, headers) = (response.status(), response.headers().clone());
    let text = response.text().await.unwrap();
    documents::check(&method, &path, status, &text);
    Answer {
        status,
        headers,
        text,
    }
}

/// Two targets that cross; 20 scans.
pub fn small() -> Value {
    json!({"name": "small", "seed": 3, "scenario": scenario(20)})
}

/// Enough work to be caught in the act, whatever the machine.
pub fn long() -> Value {
    let mut body = small();
    body["scenario"]["scans"] = json!(100_000);
    body["scenario"]["sensors"][0]["clutter_per_scan"] = json!(100.0);
    body
}

pub fn scenario(scans: u32) -> Value {
    json!({
        "scans": scans, "scan_period_s": 2.0,
        "sensors": [{"sensor_id": "radar", "max_range_m": 20_000.0, "p_d": 0.9, "sigma_x_m": 30.0, "sigma_y_m": 30.0, "clutter_per_scan": 2.0}],
        "targets": {"kind": "listed", "targets": [
            {"truth_id": "A", "x_m": -4000.0, "y_m": 0.0, "vx_mps": 200.0, "vy_mps": 0.0},
            {"truth_id": "B", "x_m": 0.0, "y_m": -4000.0, "vx_mps": 0.0, "vy_mps": 200.0}
        ]}
    })
}

/// A job that cannot succeed, which only its data tell: tracks of places cannot begin at directions.
pub async fn failing(api: &Api) -> Value {
    let id = api
        .dataset("time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,radar,a,1,2\n1,2,radar,b,1,2\n")
        .await;
    let truth = api
        .dataset("time_s,truth_id,bearing_deg\n0,t,1\n1,t,2\n")
        .await;
    json!({
        "input": {"source": "dataset", "dataset_id": id}, "truth": {"source": "dataset", "dataset_id": truth},
        "sensors": [{"sensor_id": "radar", "sigma_x_m": 1.0, "sigma_y_m": 1.0}], "tracker": {"initiation": {"method": "truth"}}
    })
}

pub fn id(job: &Value) -> &str {
    job["id"].as_str().unwrap_or_else(|| panic!("no id: {job}"))
}

/// Waits for what happens elsewhere.
pub async fn eventually(holds: impl Fn() -> bool) {
    for _ in 0..200 {
        if holds() {
            return;
        }
        tokio::time::sleep(std::time::Duration::from_millis(25)).await;
    }
    panic!("it never came true");
}
