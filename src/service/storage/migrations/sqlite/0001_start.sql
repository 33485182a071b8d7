-- Datasets, jobs and what belongs to them. Ids are UUIDs (version 7) in text; times are microseconds since 1970, UTC.
-- A deleted job or dataset keeps its row, so that asking for it says "gone".

CREATE TABLE datasets (
    id            TEXT PRIMARY KEY,
    name          TEXT NOT NULL,
    kind          TEXT NOT NULL,
    format        TEXT NOT NULL,
    bytes         INTEGER NOT NULL,
    sha256        TEXT NOT NULL,
    -- What the uploader said, hashed: the same content with the same words is the same dataset.
    meta_sha256   TEXT NOT NULL,
    columns       TEXT NOT NULL,
    summary       TEXT NOT NULL,
    sensors       TEXT NOT NULL,
    warnings      TEXT NOT NULL,
    origin_job_id TEXT,
    file_name     TEXT,
    created_at    INTEGER NOT NULL,
    deleted_at    INTEGER
) STRICT;

CREATE INDEX datasets_by_time ON datasets (created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX datasets_by_sha256 ON datasets (sha256) WHERE deleted_at IS NULL;
CREATE UNIQUE INDEX datasets_once ON datasets (sha256, meta_sha256) WHERE deleted_at IS NULL AND origin_job_id IS NULL;

CREATE TABLE jobs (
    id                  TEXT PRIMARY KEY,
    kind                TEXT NOT NULL,
    state               TEXT NOT NULL CHECK (state IN ('queued', 'running', 'succeeded', 'failed', 'canceled')),
    -- How often it was started, and how often the process died meanwhile.
    attempt             INTEGER NOT NULL DEFAULT 0,
    crashes             INTEGER NOT NULL DEFAULT 0,
    name                TEXT,
    labels              TEXT NOT NULL DEFAULT '{}',
    spec                TEXT NOT NULL,
    spec_sha256         TEXT NOT NULL,
    seed                INTEGER NOT NULL,
    engine_version      TEXT NOT NULL,
    created_at          INTEGER NOT NULL,
    queued_at           INTEGER NOT NULL,
    started_at          INTEGER,
    finished_at         INTEGER,
    cancel_requested_at INTEGER,
    deleted_at          INTEGER,
    progress            TEXT,
    error               TEXT,
    warnings            TEXT NOT NULL DEFAULT '[]',
    duplicate_of        TEXT,
    rerun_of            TEXT,
    -- Number of the job's last event.
    last_seq            INTEGER NOT NULL DEFAULT 0
) STRICT;

CREATE INDEX jobs_by_time ON jobs (created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX jobs_by_state ON jobs (state, created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX jobs_by_kind ON jobs (kind, created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX jobs_by_spec ON jobs (spec_sha256, kind, created_at) WHERE state = 'succeeded' AND deleted_at IS NULL;

CREATE TABLE job_labels (
    job_id TEXT NOT NULL REFERENCES jobs (id),
    key    TEXT NOT NULL,
    value  TEXT NOT NULL,
    PRIMARY KEY (job_id, key)
) STRICT, WITHOUT ROWID;

CREATE INDEX job_labels_by_value ON job_labels (key, value, job_id);

CREATE TABLE job_events (
    job_id TEXT NOT NULL REFERENCES jobs (id),
    seq    INTEGER NOT NULL,
    type   TEXT NOT NULL,
    at     INTEGER NOT NULL,
    data   TEXT NOT NULL,
    PRIMARY KEY (job_id, seq)
) STRICT, WITHOUT ROWID;

-- What a job reads: datasets, and other jobs, for which it waits.
CREATE TABLE job_dependencies (
    job_id      TEXT NOT NULL REFERENCES jobs (id),
    source_kind TEXT NOT NULL CHECK (source_kind IN ('job', 'dataset')),
    source_id   TEXT NOT NULL,
    PRIMARY KEY (job_id, source_kind, source_id)
) STRICT, WITHOUT ROWID;

CREATE INDEX job_dependencies_by_source ON job_dependencies (source_kind, source_id);

CREATE TABLE artifacts (
    job_id     TEXT NOT NULL REFERENCES jobs (id),
    name       TEXT NOT NULL,
    position   INTEGER NOT NULL,
    media_type TEXT NOT NULL,
    bytes      INTEGER NOT NULL,
    sha256     TEXT NOT NULL,
    dataset_id TEXT,
    PRIMARY KEY (job_id, name)
) STRICT, WITHOUT ROWID;

CREATE INDEX artifacts_by_sha256 ON artifacts (sha256);

CREATE TABLE idempotency_keys (
    key            TEXT PRIMARY KEY,
    request_sha256 TEXT NOT NULL,
    job_id         TEXT NOT NULL REFERENCES jobs (id),
    created_at     INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
