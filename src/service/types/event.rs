//! Events of a job: a gap-free sequence from 1, told live and kept.

use super::job::{JobState, Progress};
use super::problem::Problem;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

/// Something that happened to a job.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Event {
    State(StateEvent),
    Progress(ProgressEvent),
    Log(LogEvent),
    Done(DoneEvent),
}

macro_rules! event {
    ($(#[$doc:meta])* $event:ident, $type:ident::$variant:ident, $data:ty) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum $type {
            $variant,
        }

        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
        pub struct $event {
            /// Counts the events of one job from 1.
            pub seq: u64,
            pub job_id: Uuid,
            #[serde(rename = "type")]
            pub event_type: $type,
            #[schema(value_type = String, format = DateTime)]
            pub at: Timestamp,
            pub data: $data,
        }
    };
}

event!(
    /// The job's state changed.
    StateEvent,
    StateEventType::State,
    StateChange
);
event!(
    /// The job got on.
    ProgressEvent,
    ProgressEventType::Progress,
    Progress
);
event!(
    /// The job has something to say.
    LogEvent,
    LogEventType::Log,
    LogLine
);
event!(
    /// The job has ended; no event follows.
    DoneEvent,
    DoneEventType::Done,
    JobEnd
);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StateChange {
    pub state: JobState,
    pub attempt: u32,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LogLine {
    pub message: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobEnd {
    pub state: JobState,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error: Option<Problem>,
}

/// What an event says, before it has a number.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum EventData {
    State(StateChange),
    Progress(Progress),
    Log(LogLine),
    Done(JobEnd),
}

impl EventData {
    /// The `type` of the event.
    pub fn type_name(&self) -> &'static str {
        match self {
            EventData::State(_) => "state",
            EventData::Progress(_) => "progress",
            EventData::Log(_) => "log",
            EventData::Done(_) => "done",
        }
    }
}

impl Event {
    pub fn new(job_id: Uuid, seq: u64, at: Timestamp, data: EventData) -> Self {
        match data {
            EventData::State(data) => Event::State(StateEvent {
                seq,
                job_id,
                event_type: StateEventType::State,
                at,
                data,
            }),
            EventData::Progress(data) => Event::Progress(ProgressEvent {
                seq,
                job_id,
                event_type: ProgressEventType::Progress,
                at,
                data,
            }),
            EventData::Log(data) => Event::Log(LogEvent {
                seq,
                job_id,
                event_type: LogEventType::Log,
                at,
                data,
            }),
            EventData::Done(data) => Event::Done(DoneEvent {
                seq,
                job_id,
                event_type: DoneEventType::Done,
                at,
                data,
            }),
        }
    }

    pub fn seq(&self) -> u64 {
        match self {
            Event::State(event) => event.seq,
            Event::Progress(event) => event.seq,
            Event::Log(event) => event.seq,
            Event::Done(event) => event.seq,
        }
    }

    /// The `event:` field of a server-sent event.
    pub fn type_name(&self) -> &'static str {
        match self {
            Event::State(_) => "state",
            Event::Progress(_) => "progress",
            Event::Log(_) => "log",
            Event::Done(_) => "done",
        }
    }

    /// No event follows this one.
    pub fn is_last(&self) -> bool {
        matches!(self, Event::Done(_))
    }
}

/// Events of a job after some number.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct EventPage {
    pub events: Vec<Event>,
    /// Give it back as `after` to get what follows.
    pub next_after: u64,
}
