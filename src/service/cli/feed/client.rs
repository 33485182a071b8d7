//! What a feed asks of the service. A service that is away, starts or is busy is asked again.

use crate::experiment::session::{EntryFate, SensorHeard, Takes};
use crate::model::fault::Fault;
use crate::model::space::Frame;
use crate::service::cli::keys::own_key;
use anyhow::{Context, anyhow, bail};
use reqwest::header::{AUTHORIZATION, HeaderMap, HeaderValue};
use reqwest::{Method, RequestBuilder, Response, StatusCode};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::time::{Duration, Instant};

/// Between attempts: at first, and at most.
const FIRST_PAUSE: Duration = Duration::from_millis(100);
const LONGEST_PAUSE: Duration = Duration::from_secs(2);
/// A service that does not take a connection, or does not answer, for so long is away. Many scans of many tracks take their time.
const CONNECT: Duration = Duration::from_secs(5);
const ANSWER: Duration = Duration::from_secs(300);

pub(super) struct Client {
    http: reqwest::Client,
    server: String,
    patience: Duration,
}

/// A session as a feed sees it.
pub(super) struct SessionSeen {
    pub id: String,
    pub url: String,
    pub request: SessionRequest,
    /// What was heard of its sensors.
    pub heard: Vec<SensorHeard>,
}

#[derive(Deserialize)]
pub(super) struct SessionRequest {
    pub origin: Option<Frame>,
    sensors: Vec<ListedSensor>,
}

#[derive(Deserialize)]
struct ListedSensor {
    sensor_id: String,
    x_m: Option<f64>,
    lat_deg: Option<f64>,
    sigma_range_rate_mps: Option<f64>,
    sigma_speed_mps: Option<f64>,
}

#[derive(Deserialize)]
struct Info {
    id: String,
    name: Option<String>,
    state: String,
    request: SessionRequest,
    live: Option<Live>,
}

#[derive(Deserialize)]
struct Live {
    sensors: Vec<SensorHeard>,
}

#[derive(Deserialize)]
struct Page {
    items: Vec<Info>,
    next_cursor: Option<String>,
}

/// What became of a batch.
pub(super) enum Reply {
    Taken(Vec<EntryFate>),
    Refused(Vec<Fault>),
}

#[derive(Deserialize)]
struct Pushed {
    scans: Vec<PushedResult>,
}

#[derive(Deserialize)]
struct PushedResult {
    fate: EntryFate,
}

/// A refusal, as RFC 9457 writes them.
#[derive(Deserialize, Default)]
#[serde(default)]
struct Problem {
    #[serde(rename = "type")]
    kind: String,
    detail: Option<String>,
    errors: Vec<Fault>,
}

impl SessionSeen {
    pub fn sensor_ids(&self) -> Vec<String> {
        let listed = self.request.sensors.iter();
        listed.map(|sensor| sensor.sensor_id.clone()).collect()
    }

    /// What a sensor takes besides places and directions, and whether it says where it is: one that the session places does not.
    pub fn takes(&self, sensor_id: &str) -> (Takes, bool) {
        let mut listed = self.request.sensors.iter();
        let Some(sensor) = listed.find(|sensor| sensor.sensor_id == sensor_id) else {
            return (Takes::default(), false);
        };
        let takes = Takes {
            range_rates: sensor.sigma_range_rate_mps.is_some(),
            velocities: sensor.sigma_speed_mps.is_some(),
        };
        (takes, sensor.x_m.is_none() && sensor.lat_deg.is_none())
    }

    /// What was heard of a sensor: its greatest number, and its latest time.
    pub fn heard_of(&self, sensor_id: &str) -> (Option<u64>, Option<f64>) {
        let mut heard = self.heard.iter();
        let found = heard.find(|heard| heard.sensor_id == sensor_id);
        found.map_or((None, None), |found| {
            (found.last_sequence, found.last_time_s)
        })
    }
}

/// With the key of the environment, if it has one.
fn headers() -> anyhow::Result<HeaderMap> {
    let mut headers = HeaderMap::new();
    if let Some(key) = own_key() {
        let value = HeaderValue::from_str(&format!("Bearer {key}"));
        let mut value = value.context("the key in the environment is no key")?;
        value.set_sensitive(true);
        headers.insert(AUTHORIZATION, value);
    }
    Ok(headers)
}

impl Client {
    pub fn new(server: &str, patience: Duration) -> anyhow::Result<Self> {
        Client::check(server)?;
        let http = reqwest::Client::builder().default_headers(headers()?);
        let http = http.connect_timeout(CONNECT).timeout(ANSWER).build()?;
        Ok(Client {
            http,
            server: server.trim_end_matches('/').to_owned(),
            patience,
        })
    }

    /// The open session of an id, a URL or a name.
    ///
    /// # Errors
    /// There is none, or several have the name.
    pub async fn find(&self, named: &str) -> anyhow::Result<SessionSeen> {
        if named.starts_with("http://") || named.starts_with("https://") {
            Client::check(named)?;
            return self.get(named.trim_end_matches('/').to_owned()).await;
        }
        if uuid::Uuid::parse_str(named).is_ok() {
            return self.get(self.url_of(named)).await;
        }
        let found = self.open_sessions_named(named).await?;
        match found.as_slice() {
            [id] => self.get(self.url_of(id)).await,
            [] => bail!("no open session is called '{named}'"),
            several => bail!(
                "several open sessions are called '{named}': {}",
                several.join(", ")
            ),
        }
    }

    fn url_of(&self, id: &str) -> String {
        format!("{}/v1/sessions/{id}", self.server)
    }

    async fn open_sessions_named(&self, name: &str) -> anyhow::Result<Vec<String>> {
        let first = format!("{}/v1/sessions?limit=200", self.server);
        let (mut url, mut found) = (first.clone(), Vec::new());
        loop {
            let page: Page = json(self.ask(self.http.get(&url)).await?).await?;
            let named = page.items.into_iter();
            let named = named.filter(|info| info.name.as_deref() == Some(name));
            found.extend(
                named
                    .filter(|info| info.state == "open")
                    .map(|info| info.id),
            );
            match page.next_cursor {
                Some(cursor) => url = format!("{first}&cursor={cursor}"),
                None => return Ok(found),
            }
        }
    }

    async fn get(&self, url: String) -> anyhow::Result<SessionSeen> {
        let info: Info = json(self.ask(self.http.get(&url)).await?).await?;
        seen(info, url)
    }

    /// Makes a session.
    pub async fn create(&self, body: &Value) -> anyhow::Result<SessionSeen> {
        let url = format!("{}/v1/sessions", self.server);
        let asked = self.post(&url, "application/json", body.to_string());
        let info: Info = json(self.ask(asked).await?).await?;
        let url = self.url_of(&info.id);
        seen(info, url)
    }

    fn post(&self, url: &str, media_type: &str, body: String) -> RequestBuilder {
        let asked = self.http.request(Method::POST, url);
        asked.header("content-type", media_type).body(body)
    }

    /// Pushes a batch of lines.
    ///
    /// # Errors
    /// The service is away for longer than one waits, or the session takes no more.
    pub async fn push(&self, url: &str, lines: String) -> anyhow::Result<Reply> {
        let asked = self.post(url, "application/x-ndjson", lines);
        let answer = self.ask(asked).await?;
        if answer.status().is_success() {
            let pushed: Pushed = json(answer).await?;
            let fates = pushed.scans.into_iter().map(|scan| scan.fate);
            return Ok(Reply::Taken(fates.collect()));
        }
        let status = answer.status();
        let problem: Problem = read(answer).await.unwrap_or_default();
        let is_of_lines = status == StatusCode::BAD_REQUEST || status.as_u16() == 422;
        if is_of_lines && !problem.errors.is_empty() {
            return Ok(Reply::Refused(problem.errors));
        }
        bail!("the session refuses: {}", problem.told(status))
    }

    /// # Errors
    /// A URL that this program cannot ask.
    fn check(url: &str) -> anyhow::Result<()> {
        if url.starts_with("https://") && !cfg!(feature = "s3") {
            bail!("{url}: https needs a program with the feature s3, or a proxy that ends TLS");
        }
        Ok(())
    }

    /// The answer. What says that the service cannot answer now is asked again for as long as one waits.
    async fn ask(&self, asked: RequestBuilder) -> anyhow::Result<Response> {
        let (since, mut pause) = (Instant::now(), FIRST_PAUSE);
        loop {
            let attempt = asked
                .try_clone()
                .context("a request cannot be sent twice")?;
            let trouble = match attempt.send().await {
                Ok(answer) if answer.status() == StatusCode::TOO_MANY_REQUESTS => {
                    tokio::time::sleep(retry_after(&answer)).await;
                    continue;
                }
                Ok(answer) if answer.status().is_server_error() => {
                    anyhow!("the service answers {}", answer.status())
                }
                Ok(answer) if answer.status() == StatusCode::CONFLICT => {
                    let problem: Problem = read(answer).await.unwrap_or_default();
                    let told = problem.told(StatusCode::CONFLICT);
                    if problem.kind != "/problems/session_elsewhere" {
                        bail!("the session refuses: {told}");
                    }
                    anyhow!(told)
                }
                Ok(answer) => return Ok(answer),
                Err(error) if error.is_builder() => return Err(error.into()),
                Err(error) => anyhow::Error::from(error),
            };
            if since.elapsed() + pause > self.patience {
                let waited_s = since.elapsed().as_secs_f64();
                return Err(trouble.context(format!("no answer within {waited_s:.1} s")));
            }
            tokio::time::sleep(pause).await;
            pause = (pause * 2).min(LONGEST_PAUSE);
        }
    }
}

/// How long a busy service asks to wait.
fn retry_after(answer: &Response) -> Duration {
    let told = answer.headers().get("retry-after");
    let told = told.and_then(|value| value.to_str().ok()?.parse().ok());
    Duration::from_secs(told.unwrap_or(1_u64).clamp(1, 60))
}

fn seen(info: Info, url: String) -> anyhow::Result<SessionSeen> {
    let Some(live) = info.live else {
        bail!("the session is {}", info.state);
    };
    Ok(SessionSeen {
        id: info.id,
        url,
        request: info.request,
        heard: live.sensors,
    })
}

async fn read<T: DeserializeOwned>(answer: Response) -> anyhow::Result<T> {
    Ok(serde_json::from_slice(&answer.bytes().await?)?)
}

/// The body of a success.
async fn json<T: DeserializeOwned>(answer: Response) -> anyhow::Result<T> {
    let status = answer.status();
    if status.is_success() {
        return read(answer)
            .await
            .context("the service answers something else");
    }
    let problem: Problem = read(answer).await.unwrap_or_default();
    bail!("the service refuses: {}", problem.told(status))
}

impl Problem {
    fn told(&self, status: StatusCode) -> String {
        let mut told = match &self.detail {
            Some(detail) => detail.clone(),
            None => status.to_string(),
        };
        for fault in &self.errors {
            told.push_str(&format!("\n  {}: {}", fault.pointer, fault.detail));
        }
        told
    }
}
