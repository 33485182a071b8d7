//! Keys on the wire.

use jiff::Timestamp;
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

/// What a key allows; the key itself is told once, when it is made.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct KeyInfo {
    pub id: Uuid,
    pub name: String,
    /// `read`, `jobs`, `datasets`, `push`, `sessions`, `keys`.
    pub actions: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub requests_per_minute: Option<u32>,
    #[schema(value_type = String, format = DateTime)]
    pub created_at: Timestamp,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = String, format = DateTime)]
    pub expires_at: Option<Timestamp>,
}

/// A key that was made.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct MadeKey {
    /// It is not told again.
    pub key: String,
    pub info: KeyInfo,
}

/// The keys that are not revoked.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct KeyList {
    /// Newest first.
    pub items: Vec<KeyInfo>,
}

/// Who asks, and what that allows.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Access {
    /// Whether the service asks for keys at all.
    pub is_needed: bool,
    /// Whether the request has one that opens anything.
    pub is_given: bool,
    pub actions: Vec<String>,
    /// Of the key, if it is not the master key.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub key_id: Option<Uuid>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false, value_type = String, format = DateTime)]
    pub expires_at: Option<Timestamp>,
}
