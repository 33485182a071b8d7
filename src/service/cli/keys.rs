//! `trackloom keys`: makes, lists and revokes the keys of a service that asks for them.

use super::BAD_INPUT;
use super::output;
use crate::service::keys::Action;
use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use reqwest::{Client, Method};
use serde::Deserialize;
use serde_json::{Value, json};
use std::process::ExitCode;
use std::time::Duration;
use uuid::Uuid;

const ANSWER: Duration = Duration::from_secs(30);

#[derive(Args)]
pub(super) struct KeysArguments {
    /// The service
    #[arg(
        long,
        env = "TRACKLOOM_SERVER",
        value_name = "URL",
        default_value = "http://127.0.0.1:8080",
        global = true
    )]
    server: String,
    #[command(subcommand)]
    command: KeysCommand,
}

#[derive(Subcommand)]
enum KeysCommand {
    /// Make a key, and print it: it is not told again
    Add {
        /// For whom or for what it is
        name: String,
        /// What it allows, divided by commas; all of them when absent
        #[arg(long, value_name = "ACTION", value_delimiter = ',', value_parser = Action::NAMES)]
        allow: Vec<String>,
        /// Days after which it ends; never when absent
        #[arg(long, value_name = "DAYS")]
        expires: Option<f64>,
        /// Requests a minute that it may make; no limit when absent
        #[arg(long, value_name = "COUNT")]
        rate: Option<u32>,
    },
    /// List the keys that are not revoked
    List,
    /// Revoke a key
    Revoke {
        /// Its id, as the list tells it
        id: Uuid,
    },
}

#[derive(Deserialize)]
struct Made {
    key: String,
}

#[derive(Deserialize)]
struct Listed {
    items: Vec<Item>,
}

#[derive(Deserialize)]
struct Item {
    id: String,
    name: String,
    actions: Vec<String>,
    expires_at: Option<String>,
}

/// The key by which the command line asks: a key, else the master key.
pub(super) fn own_key() -> Option<String> {
    let of = |name| std::env::var(name).ok().filter(|text| !text.is_empty());
    of("TRACKLOOM_API_KEY").or_else(|| of("TRACKLOOM_MASTER_KEY"))
}

pub(super) fn run(arguments: &KeysArguments) -> ExitCode {
    let Some(key) = own_key() else {
        eprintln!(
            "trackloom: set TRACKLOOM_MASTER_KEY, or TRACKLOOM_API_KEY to a key that allows 'keys'"
        );
        return ExitCode::from(BAD_INPUT);
    };
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let done = runtime
        .map_err(anyhow::Error::from)
        .and_then(|runtime| runtime.block_on(act(arguments, &key)));
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("trackloom: {error:#}");
            ExitCode::FAILURE
        }
    }
}

async fn act(arguments: &KeysArguments, key: &str) -> anyhow::Result<()> {
    let client = Client::builder().timeout(ANSWER).build()?;
    let url = format!("{}/v1/keys", arguments.server.trim_end_matches('/'));
    let ask = async |method: Method, url: String, body: Option<Value>| {
        let mut request = client.request(method, url).bearer_auth(key);
        if let Some(body) = body {
            let request_body = body.to_string();
            request = request
                .header("content-type", "application/json")
                .body(request_body);
        }
        let response = request
            .send()
            .await
            .context("the service does not answer")?;
        let status = response.status();
        let text = response.text().await?;
        if !status.is_success() {
            bail!("the service refused: {}", refusal(&text));
        }
        Ok(text)
    };
    match &arguments.command {
        KeysCommand::Add {
            name,
            allow,
            expires,
            rate,
        } => {
            let body = request(name, allow, *expires, *rate);
            let made: Made = serde_json::from_str(&ask(Method::POST, url, Some(body)).await?)?;
            output::print(made.key)?;
        }
        KeysCommand::List => {
            let listed: Listed = serde_json::from_str(&ask(Method::GET, url, None).await?)?;
            for item in listed.items {
                let end = item.expires_at.unwrap_or_else(|| "never".to_owned());
                output::print(format_args!(
                    "{}  {}  ends {end}  {}",
                    item.id,
                    item.actions.join(","),
                    item.name
                ))?;
            }
        }
        KeysCommand::Revoke { id } => {
            ask(Method::DELETE, format!("{url}/{id}"), None).await?;
            output::print(format_args!("{id} is revoked"))?;
        }
    }
    Ok(())
}

fn request(name: &str, allow: &[String], expires: Option<f64>, rate: Option<u32>) -> Value {
    let mut body = json!({"name": name, "actions": allow});
    if allow.is_empty() {
        body["actions"] = json!(Action::NAMES);
    }
    if let Some(days) = expires {
        body["expires_in_days"] = json!(days);
    }
    if let Some(rate) = rate {
        body["requests_per_minute"] = json!(rate);
    }
    body
}

/// The words of a problem.
fn refusal(text: &str) -> String {
    #[derive(Deserialize)]
    struct Problem {
        detail: String,
    }
    serde_json::from_str::<Problem>(text).map_or_else(|_| text.to_owned(), |problem| problem.detail)
}
