//! Who may do what: keys with actions, an end and a rate. Without a master key everybody may do everything.

mod action;
mod token;

pub use action::{Action, Need, OPEN, need_of};
pub use token::MasterKey;

use super::error::ServiceError;
use super::rate::Rate;
use super::storage::{NewKey, Storage, StoredKey};
use super::types::{KeyInfo, KeyList, MadeKey};
use crate::model::fault::Fault;
use crate::registry::{self, Kind, Object, list, number, optional, required, whole};
use jiff::{SignedDuration, Timestamp};
use serde::Deserialize;
use serde_json::Value;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use token::Bearer;
use uuid::Uuid;

pub static KEY: Object = Object {
    name: "KeyRequest",
    summary: "Make a key for a program or a person. What it allows is listed; more than the key that makes it has it cannot allow.",
    fields: &[
        required(
            "name",
            "For whom or for what it is.",
            Kind::Text { max_length: 200 },
        ),
        required(
            "actions",
            "What it allows: read everything; change jobs; upload and delete datasets; push scans into sessions; begin, change and end sessions; make and revoke keys.",
            list(&Kind::Choice(&Action::NAMES), 1, Action::NAMES.len()),
        ),
        optional(
            "expires_in_days",
            "When it ends. Never when absent.",
            number(0.0, 36_500.0, "d"),
        ),
        optional(
            "requests_per_minute",
            "More are answered 429, with what was not used of one minute at once. No limit when absent.",
            whole(1, 1_000_000, "1/min"),
        ),
    ],
};

#[derive(Deserialize)]
struct KeySpec {
    name: String,
    actions: Vec<String>,
    expires_in_days: Option<f64>,
    requests_per_minute: Option<u32>,
}

/// What was not used of so long may be used at once.
const SAVED: Duration = Duration::from_secs(60);

/// Who asks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    /// Absent of the master key, and where no keys are needed.
    pub id: Option<Uuid>,
    pub name: Option<String>,
    pub actions: Vec<Action>,
    pub expires_at: Option<Timestamp>,
}

/// Why somebody is not let in.
#[derive(Debug)]
pub enum Refusal {
    Unknown,
    Expired,
    Revoked,
    TooOften,
    Failed(anyhow::Error),
}

impl Holder {
    fn master() -> Self {
        Holder {
            id: None,
            name: None,
            actions: Action::ALL.to_vec(),
            expires_at: None,
        }
    }

    pub fn may(&self, need: Need) -> bool {
        match need {
            Need::Nothing | Need::AnyKey => true,
            Need::Action(action) => self.actions.contains(&action),
        }
    }
}

/// The keys of a service.
pub struct Keys {
    master: Option<MasterKey>,
    storage: Storage,
    rates: Mutex<HashMap<Uuid, Rate>>,
}

impl Keys {
    pub fn new(master: Option<MasterKey>, storage: Storage) -> Self {
        Keys {
            master,
            storage,
            rates: Mutex::default(),
        }
    }

    pub fn are_needed(&self) -> bool {
        self.master.is_some()
    }

    /// Who has this token. Where no keys are needed everybody is whoever may do everything.
    ///
    /// # Errors
    /// Nobody; a key that has ended; one that asks too often.
    pub async fn holder(&self, token: Option<&str>) -> Result<Holder, Refusal> {
        let Some(master) = &self.master else {
            return Ok(Holder::master());
        };
        match master.whose(token.unwrap_or_default()) {
            None => Err(Refusal::Unknown),
            Some(Bearer::Master) => Ok(Holder::master()),
            Some(Bearer::Key(id)) => self.holder_of(id).await,
        }
    }

    async fn holder_of(&self, id: Uuid) -> Result<Holder, Refusal> {
        let stored = self.storage.key(id).await.map_err(Refusal::Failed)?;
        let stored = stored.ok_or(Refusal::Revoked)?;
        if stored.revoked_at.is_some() {
            return Err(Refusal::Revoked);
        }
        if stored.expires_at.is_some_and(|end| end <= Timestamp::now()) {
            return Err(Refusal::Expired);
        }
        if let Some(most) = stored.requests_per_minute
            && !self.count(id, most)
        {
            return Err(Refusal::TooOften);
        }
        Ok(Holder {
            id: Some(id),
            name: Some(stored.name),
            actions: actions_of(&stored.actions),
            expires_at: stored.expires_at,
        })
    }

    fn count(&self, id: Uuid, most: u32) -> bool {
        let (per_s, now) = (f64::from(most) / 60.0, Instant::now());
        let mut rates = self.rates.lock().unwrap_or_else(PoisonError::into_inner);
        let rate = rates
            .entry(id)
            .or_insert_with(|| Rate::new(per_s, SAVED, now));
        rate.take(1, now)
    }

    /// Makes a key, which is told once.
    ///
    /// # Errors
    /// Faults of the request; more than its maker may; no keys are needed.
    pub async fn add(&self, body: &Value, maker: &Holder) -> Result<MadeKey, ServiceError> {
        let Some(master) = &self.master else {
            let detail = "this service needs no keys: start it with a master key";
            let fault = Fault::new("", "conflict", detail);
            return Err(ServiceError::Invalid(vec![
                fault.allowing("TRACKLOOM_MASTER_KEY, or --master-key-file"),
            ]));
        };
        let checked = registry::check(body, &KEY).map_err(ServiceError::Invalid)?;
        let spec = KeySpec::deserialize(&checked).map_err(anyhow::Error::from)?;
        let faults = beyond(&spec, maker);
        if !faults.is_empty() {
            return Err(ServiceError::Invalid(faults));
        }
        let new = NewKey {
            name: spec.name,
            actions: spec.actions,
            expires_at: spec.expires_in_days.and_then(after_days),
            requests_per_minute: spec.requests_per_minute,
        };
        let stored = self.storage.add_key(new).await?;
        Ok(MadeKey {
            key: master.token(stored.id),
            info: told(stored),
        })
    }

    /// Those that are not revoked, newest first.
    pub async fn list(&self) -> Result<KeyList, ServiceError> {
        let stored = self.storage.keys().await?;
        Ok(KeyList {
            items: stored.into_iter().map(told).collect(),
        })
    }

    /// From now on it opens nothing.
    pub async fn revoke(&self, id: Uuid) -> Result<(), ServiceError> {
        match self.storage.revoke_key(id).await? {
            true => Ok(()),
            false => Err(ServiceError::NotFound("key")),
        }
    }
}

/// Nobody gives away what is not theirs, nor for longer.
fn beyond(spec: &KeySpec, maker: &Holder) -> Vec<Fault> {
    let mut faults = Vec::new();
    let own: Vec<&str> = maker.actions.iter().map(|action| action.name()).collect();
    for (index, name) in spec.actions.iter().enumerate() {
        if !own.contains(&name.as_str()) {
            let detail = format!("the key that makes it does not allow '{name}' itself");
            let fault = Fault::new(format!("/actions/{index}"), "conflict", detail);
            faults.push(fault.allowing(own.join(", ")));
        }
    }
    let end = spec.expires_in_days.and_then(after_days);
    if let Some(own_end) = maker.expires_at
        && end.is_none_or(|end| end > own_end)
    {
        let detail = format!("the key that makes it ends at {own_end}");
        let fault = Fault::new("/expires_in_days", "out_of_range", detail);
        faults.push(fault.allowing(format!("an end before {own_end}")));
    }
    faults
}

fn after_days(days: f64) -> Option<Timestamp> {
    let span = SignedDuration::try_from_secs_f64(days * 86_400.0).ok()?;
    Timestamp::now().checked_add(span).ok()
}

fn actions_of(names: &[String]) -> Vec<Action> {
    names
        .iter()
        .filter_map(|name| Action::from_name(name))
        .collect()
}

fn told(stored: StoredKey) -> KeyInfo {
    KeyInfo {
        id: stored.id,
        name: stored.name,
        actions: stored.actions,
        requests_per_minute: stored.requests_per_minute,
        created_at: stored.created_at,
        expires_at: stored.expires_at,
    }
}
