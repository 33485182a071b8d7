//! Options of who may use the service, and how much of it.

use crate::service::config::{Config, ConnectionLimits};
use crate::service::keys::MasterKey;
use clap::Args;
use std::net::SocketAddr;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct AccessArguments {
    /// A name by which the service is asked, besides localhost and the addresses of the machine; repeat it for more
    #[arg(long = "allow-host", env = "TRACKLOOM_ALLOW_HOST", value_name = "NAME", value_delimiter = ',', value_parser = host_name)]
    allowed_hosts: Vec<String>,
    /// A site whose pages may use the service from a browser, such as https://radar.example.org: it is told so by CORS, without cookies; repeat it
    /// for more
    #[arg(long = "allow-origin", env = "TRACKLOOM_ALLOW_ORIGIN", value_name = "ORIGIN", value_delimiter = ',', value_parser = origin)]
    allowed_origins: Vec<String>,
    /// A file with the master key, 16 characters or more: with it every request needs a key, which `trackloom keys` makes. The variable
    /// TRACKLOOM_MASTER_KEY has the key itself
    #[arg(long, env = "TRACKLOOM_MASTER_KEY_FILE", value_name = "FILE")]
    master_key_file: Option<PathBuf>,
    /// Listen on an address that other machines reach without a master key, although everybody who reaches it may read and change everything
    #[arg(long, env = "TRACKLOOM_INSECURE")]
    insecure: bool,
    /// Connections open at the same time; half of the files that the process may open when absent, at most 4096
    #[arg(long, env = "TRACKLOOM_MAX_CONNECTIONS", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    max_connections: Option<u32>,
    /// Event streams open at the same time; half of the connections when absent
    #[arg(long, env = "TRACKLOOM_MAX_STREAMS", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    max_streams: Option<u32>,
    /// Event streams of one client address; 128 when absent. A reverse proxy is one client
    #[arg(long, env = "TRACKLOOM_MAX_STREAMS_PER_CLIENT", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    max_streams_per_client: Option<u32>,
}

/// What stands in the header `Host` without its port; every port is allowed.
fn host_name(text: &str) -> Result<String, String> {
    let is_name = !text.is_empty()
        && text
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || b"-._".contains(&byte));
    let is_address = text.starts_with('[') && text.ends_with(']');
    if is_name || is_address {
        Ok(text.to_owned())
    } else {
        Err("give a name such as trackloom.example.org, without scheme and port".to_owned())
    }
}

/// A scheme, a host, and perhaps a port: what browsers send in the header `Origin`.
fn origin(text: &str) -> Result<String, String> {
    let https = text.strip_prefix("https://");
    let authority = https.or_else(|| text.strip_prefix("http://"));
    let is_part = |byte: u8| byte.is_ascii_alphanumeric() || b"-._:[]".contains(&byte);
    match authority {
        Some(host) if !host.is_empty() && host.bytes().all(is_part) => Ok(text.to_owned()),
        _ => Err(
            "give a scheme and a host, such as https://radar.example.org, without a path"
                .to_owned(),
        ),
    }
}

impl AccessArguments {
    /// # Errors
    /// A master key that cannot be used; without one an address that other machines reach, unless that is meant; if it is, that is told.
    pub(super) fn check(&self, listen: SocketAddr) -> Result<(), String> {
        let is_locked = self.master_key()?.is_some();
        if is_locked || listen.ip().is_loopback() {
            return Ok(());
        }
        if !self.insecure {
            return Err(format!(
                "--listen {listen} is refused without a master key: everybody who reaches the address could read and change everything. \
                 Say --master-key-file or TRACKLOOM_MASTER_KEY, listen on 127.0.0.1 behind a reverse proxy that asks who it is, or say \
                 --insecure if every machine that reaches it is trusted"
            ));
        }
        eprintln!(
            "trackloom: warning: everybody who reaches {listen} can read and change everything"
        );
        Ok(())
    }

    /// Of the file, else of the variable.
    fn master_key(&self) -> Result<Option<MasterKey>, String> {
        let text = match &self.master_key_file {
            Some(file) => std::fs::read_to_string(file).map_err(|error| {
                format!("the master key cannot be read: {}: {error}", file.display())
            })?,
            None => match std::env::var("TRACKLOOM_MASTER_KEY") {
                Ok(text) => text,
                Err(_) => return Ok(None),
            },
        };
        MasterKey::new(&text).map(Some)
    }

    pub(super) fn apply(&self, config: &mut Config) {
        // It has been checked before anything else.
        config.master_key = self.master_key().ok().flatten();
        config.allowed_hosts.clone_from(&self.allowed_hosts);
        config.allowed_origins.clone_from(&self.allowed_origins);
        let limits = &mut config.connections;
        if let Some(most) = self.max_connections {
            *limits = ConnectionLimits::of(most as usize);
        }
        if let Some(most) = self.max_streams {
            limits.streams = most as usize;
            limits.streams_per_client = limits.streams_per_client.min(limits.streams);
        }
        if let Some(most) = self.max_streams_per_client {
            limits.streams_per_client = most as usize;
        }
    }
}
