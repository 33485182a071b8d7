-- Datasets, jobs, campaigns and what belongs to them, as in the SQLite file. Ids are UUIDs (version 7) in text; times are
-- microseconds since 1970, UTC; JSON is text. A deleted job or dataset keeps its row, so that asking for it says "gone".

-- Whoever writes locks it, so that two changes never meet half-way.
CREATE TABLE one_writer (nothing INTEGER);

-- Locked for sharing while files wait for their rows, and for itself while unused files are removed.
CREATE TABLE sweeping (nothing INTEGER);

-- What all processes must agree on.
CREATE TABLE settings (
    name  TEXT PRIMARY KEY,
    value TEXT NOT NULL
);

CREATE TABLE datasets (
    id            TEXT COLLATE "C" PRIMARY KEY,
    name          TEXT NOT NULL,
    kind          TEXT NOT NULL,
    format        TEXT NOT NULL,
    bytes         BIGINT NOT NULL,
    sha256        TEXT NOT NULL,
    -- What the uploader said, hashed: the same content with the same words is the same dataset.
    meta_sha256   TEXT NOT NULL,
    columns       TEXT NOT NULL,
    summary       TEXT NOT NULL,
    sensors       TEXT NOT NULL,
    warnings      TEXT NOT NULL,
    origin_job_id TEXT,
    file_name     TEXT,
    created_at    BIGINT NOT NULL,
    deleted_at    BIGINT,
    bearing_time  TEXT NOT NULL DEFAULT 'null'
);

CREATE INDEX datasets_by_time ON datasets (created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX datasets_by_sha256 ON datasets (sha256) WHERE deleted_at IS NULL;
CREATE UNIQUE INDEX datasets_once ON datasets (sha256, meta_sha256) WHERE deleted_at IS NULL AND origin_job_id IS NULL;

CREATE TABLE jobs (
    id                  TEXT COLLATE "C" PRIMARY KEY,
    kind                TEXT NOT NULL,
    state               TEXT NOT NULL CHECK (state IN ('queued', 'running', 'succeeded', 'failed', 'canceled')),
    -- How often it was started, and how often the process died meanwhile.
    attempt             BIGINT NOT NULL DEFAULT 0,
    crashes             BIGINT NOT NULL DEFAULT 0,
    name                TEXT,
    labels              TEXT NOT NULL DEFAULT '{}',
    spec                TEXT NOT NULL,
    spec_sha256         TEXT NOT NULL,
    seed                BIGINT NOT NULL,
    engine_version      TEXT NOT NULL,
    created_at          BIGINT NOT NULL,
    queued_at           BIGINT NOT NULL,
    started_at          BIGINT,
    finished_at         BIGINT,
    cancel_requested_at BIGINT,
    deleted_at          BIGINT,
    progress            TEXT,
    error               TEXT,
    warnings            TEXT NOT NULL DEFAULT '[]',
    duplicate_of        TEXT,
    rerun_of            TEXT,
    -- Number of the job's last event.
    last_seq            BIGINT NOT NULL DEFAULT 0,
    -- How urgent it is; greater goes first. And the queue's entry through which it was taken.
    priority            BIGINT NOT NULL DEFAULT 0,
    entry               TEXT,
    -- When it was last put into the queue; NULL: it still has to be.
    enqueued_at         BIGINT
);

CREATE INDEX jobs_by_time ON jobs (created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX jobs_by_state ON jobs (state, created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX jobs_by_kind ON jobs (kind, created_at, id) WHERE deleted_at IS NULL;
CREATE INDEX jobs_by_spec ON jobs (spec_sha256, kind, created_at) WHERE state = 'succeeded' AND deleted_at IS NULL;

CREATE TABLE job_labels (
    job_id TEXT NOT NULL REFERENCES jobs (id),
    key    TEXT NOT NULL,
    value  TEXT NOT NULL,
    PRIMARY KEY (job_id, key)
);

CREATE INDEX job_labels_by_value ON job_labels (key, value, job_id);

CREATE TABLE job_events (
    job_id TEXT NOT NULL REFERENCES jobs (id),
    seq    BIGINT NOT NULL,
    type   TEXT NOT NULL,
    at     BIGINT NOT NULL,
    data   TEXT NOT NULL,
    PRIMARY KEY (job_id, seq)
);

-- What a job reads: datasets, and other jobs, for which it waits.
CREATE TABLE job_dependencies (
    job_id      TEXT NOT NULL REFERENCES jobs (id),
    source_kind TEXT NOT NULL CHECK (source_kind IN ('job', 'dataset')),
    source_id   TEXT NOT NULL,
    PRIMARY KEY (job_id, source_kind, source_id)
);

CREATE INDEX job_dependencies_by_source ON job_dependencies (source_kind, source_id);

CREATE TABLE artifacts (
    job_id     TEXT NOT NULL REFERENCES jobs (id),
    name       TEXT NOT NULL,
    position   BIGINT NOT NULL,
    media_type TEXT NOT NULL,
    bytes      BIGINT NOT NULL,
    sha256     TEXT NOT NULL,
    dataset_id TEXT,
    PRIMARY KEY (job_id, name)
);

CREATE INDEX artifacts_by_sha256 ON artifacts (sha256);

CREATE TABLE idempotency_keys (
    key            TEXT PRIMARY KEY,
    request_sha256 TEXT NOT NULL,
    job_id         TEXT NOT NULL REFERENCES jobs (id),
    created_at     BIGINT NOT NULL
);

-- A campaign is worked off in chunks: runs, and between them looks at what there is and what comes next.
CREATE TABLE campaigns (
    job_id     TEXT PRIMARY KEY REFERENCES jobs (id),
    -- What is kept of each run, as JSON, once the first run has told.
    outcomes   TEXT,
    runs_done  BIGINT NOT NULL DEFAULT 0,
    runs_total BIGINT NOT NULL,
    -- When progress was last told as an event.
    told_at    BIGINT NOT NULL DEFAULT 0
);

CREATE TABLE chunks (
    job_id      TEXT NOT NULL REFERENCES jobs (id),
    number      BIGINT NOT NULL,
    kind        TEXT NOT NULL CHECK (kind IN ('pilot', 'runs', 'look')),
    -- The runs to make, as JSON: ranges of their numbers.
    items       TEXT NOT NULL,
    state       TEXT NOT NULL CHECK (state IN ('queued', 'running', 'done', 'failed')),
    attempt     BIGINT NOT NULL DEFAULT 0,
    crashes     BIGINT NOT NULL DEFAULT 0,
    entry       TEXT,
    enqueued_at BIGINT,
    -- What the runs gave, as JSON; written once, together with the progress.
    piece       TEXT,
    PRIMARY KEY (job_id, number)
);

CREATE INDEX chunks_to_do ON chunks (state, job_id) WHERE state IN ('queued', 'running');
