//! Live sessions on the wire.

pub use crate::experiment::session::{
    EntryFate, LatePolicy, LiveTrack, SensorHeard, SessionCounts, SessionEvent, SessionEventKind,
    SessionPicture, TrackHistory,
};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use utoipa::ToSchema;
use uuid::Uuid;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SessionState {
    /// It takes scans.
    Open,
    /// It is a recording.
    Closed,
    /// Its tracker would have held more than it may.
    Failed,
}

impl SessionState {
    pub fn name(self) -> &'static str {
        match self {
            SessionState::Open => "open",
            SessionState::Closed => "closed",
            SessionState::Failed => "failed",
        }
    }

    /// A name that is not known is that of a later version: nothing is taken.
    pub fn from_name(name: &str) -> Self {
        match name {
            "open" => SessionState::Open,
            "failed" => SessionState::Failed,
            _ => SessionState::Closed,
        }
    }
}

/// A live session.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct SessionInfo {
    pub id: Uuid,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    pub labels: BTreeMap<String, String>,
    pub state: SessionState,
    /// Entries of its log: scans, heartbeats, and what was done by hand.
    pub entries: u64,
    /// Bytes of its log.
    pub log_bytes: u64,
    #[schema(value_type = String, format = DateTime)]
    pub created_at: Timestamp,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = String, format = DateTime)]
    pub closed_at: Option<Timestamp>,
    /// The detections of a closed session.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub dataset_id: Option<Uuid>,
    /// The job that tracks them with the settings of the session.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub job_id: Option<Uuid>,
    /// Of a closed session: what the tracks 1, 2, … of the job were called while it was open. Absent where tracks were begun, ended or
    /// dropped otherwise than by the rules that the job knows.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub track_ids: Option<Vec<String>>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = Object)]
    pub fault: Option<Value>,
    /// The request with its defaults.
    #[schema(value_type = Object)]
    pub request: Value,
    /// Of one that is open; in lists of those that the process which answers has in memory.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub live: Option<SessionLive>,
}

/// How an open session stands.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct SessionLive {
    pub counts: SessionCounts,
    /// Whether it takes no scans for the time being.
    pub is_paused: bool,
    /// Time of the last scan that the tracker took.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub processed_to_s: Option<f64>,
    /// How far the tracker is behind what was heard of the sensors, in their time.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub lag_s: Option<f64>,
    /// Scans that wait for others.
    pub waiting: u64,
    /// Living tracks.
    pub tracks: u64,
    /// Those of them that are confirmed.
    pub confirmed: u64,
    /// Number of the latest event.
    pub last_event: u64,
    /// What was heard of each sensor.
    pub sensors: Vec<SensorHeard>,
    /// What is assumed of its sensors.
    pub warnings: Vec<String>,
}

/// One page of sessions.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct SessionPage {
    pub items: Vec<SessionInfo>,
    /// Absent at the end of the list.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub next_cursor: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub total: Option<u64>,
}

/// What became of pushed scans. All that is new is on the disk, and told by the tracker as far as `processed_to_s`.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Pushed {
    /// In the order in which they were pushed.
    pub scans: Vec<PushedResult>,
    /// Entries of the log now.
    pub entries: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub processed_to_s: Option<f64>,
    pub waiting: u64,
    /// Number of the latest event.
    pub last_event: u64,
    /// What happened; the latest, where there are too many.
    pub events: Vec<SessionEvent>,
}

/// What became of one scan.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct PushedResult {
    pub fate: EntryFate,
    pub sensor_id: String,
    /// As it was given, or the next one of the sensor.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sequence: Option<u64>,
}

/// The tracks of a session as they are believed to be.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct LiveTracks {
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub processed_to_s: Option<f64>,
    pub last_event: u64,
    pub tracks: Vec<LiveTrack>,
}

/// Events of a session.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct SessionEvents {
    /// Oldest first.
    pub items: Vec<SessionEvent>,
    /// Number of the latest event of the session.
    pub last_event: u64,
}
