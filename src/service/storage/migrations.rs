//! The tables as versions of the program made them, one change after the other.

/// Version, description and text of each migration; their texts never change.
pub type Migrations = [(i64, &'static str, &'static str)];

pub const SQLITE_TABLES: &Migrations = &[
    (1, "start", include_str!("migrations/sqlite/0001_start.sql")),
    (
        2,
        "bearing time",
        include_str!("migrations/sqlite/0002_bearing_time.sql"),
    ),
    (
        3,
        "chunks",
        include_str!("migrations/sqlite/0003_chunks.sql"),
    ),
    (4, "blobs", include_str!("migrations/sqlite/0004_blobs.sql")),
    (
        5,
        "format options",
        include_str!("migrations/sqlite/0005_format_options.sql"),
    ),
    (
        6,
        "sessions",
        include_str!("migrations/sqlite/0006_sessions.sql"),
    ),
    (
        7,
        "live tracks",
        include_str!("migrations/sqlite/0007_live_tracks.sql"),
    ),
    (
        8,
        "log bytes",
        include_str!("migrations/sqlite/0008_log_bytes.sql"),
    ),
    (9, "keys", include_str!("migrations/sqlite/0009_keys.sql")),
    (10, "pins", include_str!("migrations/sqlite/0010_pins.sql")),
];

pub const POSTGRES_TABLES: &Migrations = &[
    (
        3,
        "start",
        include_str!("migrations/postgres/0003_start.sql"),
    ),
    (
        4,
        "queue",
        include_str!("migrations/postgres/0004_queue.sql"),
    ),
    (
        5,
        "format options",
        include_str!("migrations/postgres/0005_format_options.sql"),
    ),
    (
        6,
        "sessions",
        include_str!("migrations/postgres/0006_sessions.sql"),
    ),
    (
        7,
        "live tracks",
        include_str!("migrations/postgres/0007_live_tracks.sql"),
    ),
    (
        8,
        "log bytes",
        include_str!("migrations/postgres/0008_log_bytes.sql"),
    ),
    (9, "keys", include_str!("migrations/postgres/0009_keys.sql")),
    (
        10,
        "pins",
        include_str!("migrations/postgres/0010_pins.sql"),
    ),
];
