//! Options of who may use the service, and how much of it.

use crate::service::config::{Config, ConnectionLimits};
use clap::Args;
use std::net::SocketAddr;

#[derive(Args)]
pub(super) struct AccessArguments {
    /// A name by which the service is asked, besides localhost and the addresses of the machine; repeat it for more
    #[arg(long = "allow-host", env = "TRACKLOOM_ALLOW_HOST", value_name = "NAME", value_delimiter = ',', value_parser = host_name)]
    allowed_hosts: Vec<String>,
    /// Listen on an address that other machines reach, although everybody who reaches it may read and change everything
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

impl AccessArguments {
    /// # Errors
    /// An address that other machines reach, unless that is meant; if it is, that is told.
    pub(super) fn check(&self, listen: SocketAddr) -> Result<(), String> {
        if listen.ip().is_loopback() {
            return Ok(());
        }
        if !self.insecure {
            return Err(format!(
                "--listen {listen} is refused: there are no accounts, so everybody who reaches the address could read and change everything. \
                 Listen on 127.0.0.1 behind a reverse proxy that asks who it is, or say --insecure if every machine that reaches it is trusted"
            ));
        }
        eprintln!(
            "trackloom: warning: everybody who reaches {listen} can read and change everything"
        );
        Ok(())
    }

    pub(super) fn apply(&self, config: &mut Config) {
        config.allowed_hosts.clone_from(&self.allowed_hosts);
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
