-- Live sessions. The log is the truth: what a session knows follows from its request and its entries; a checkpoint makes a start short.
CREATE TABLE sessions (
    id                 TEXT PRIMARY KEY,
    name               TEXT,
    labels             TEXT NOT NULL DEFAULT '{}',
    -- The request with its defaults, as JSON.
    spec               TEXT NOT NULL,
    state              TEXT NOT NULL CHECK (state IN ('open', 'closed', 'failed')),
    -- Why it failed, as JSON.
    fault              TEXT,
    -- Entries of its log.
    entries            INTEGER NOT NULL DEFAULT 0,
    -- Which process has it, until when, and where that is reached; each owner has a greater number than the one before.
    owner              TEXT,
    leased_until       INTEGER NOT NULL DEFAULT 0,
    address            TEXT,
    fence              INTEGER NOT NULL DEFAULT 0,
    -- What the session knew after so many entries, and the version that wrote it.
    checkpoint         BLOB,
    checkpoint_entries INTEGER NOT NULL DEFAULT 0,
    checkpoint_version TEXT,
    -- What became of a closed one.
    dataset_id         TEXT,
    job_id             TEXT,
    created_at         INTEGER NOT NULL,
    closed_at          INTEGER,
    deleted_at         INTEGER
) STRICT;

CREATE INDEX sessions_by_time ON sessions (created_at, id) WHERE deleted_at IS NULL;

CREATE TABLE session_log (
    session_id TEXT NOT NULL,
    -- From 1, without gaps.
    position   INTEGER NOT NULL,
    entry      TEXT NOT NULL,
    PRIMARY KEY (session_id, position)
) STRICT, WITHOUT ROWID;
