-- How urgent a job is; greater goes first. And the queue's entry through which it was taken.
ALTER TABLE jobs ADD COLUMN priority INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN entry TEXT;
-- When it was last put into the queue; NULL: it still has to be.
ALTER TABLE jobs ADD COLUMN enqueued_at INTEGER;

-- A campaign is worked off in chunks: runs, and between them looks at what there is and what comes next.
CREATE TABLE campaigns (
    job_id     TEXT PRIMARY KEY REFERENCES jobs (id),
    -- What is kept of each run, as JSON, once the first run has told.
    outcomes   TEXT,
    runs_done  INTEGER NOT NULL DEFAULT 0,
    runs_total INTEGER NOT NULL,
    -- When progress was last told as an event.
    told_at    INTEGER NOT NULL DEFAULT 0
) STRICT, WITHOUT ROWID;

CREATE TABLE chunks (
    job_id      TEXT NOT NULL REFERENCES jobs (id),
    number      INTEGER NOT NULL,
    kind        TEXT NOT NULL CHECK (kind IN ('pilot', 'runs', 'look')),
    -- The runs to make, as JSON: ranges of their numbers.
    items       TEXT NOT NULL,
    state       TEXT NOT NULL CHECK (state IN ('queued', 'running', 'done', 'failed')),
    attempt     INTEGER NOT NULL DEFAULT 0,
    crashes     INTEGER NOT NULL DEFAULT 0,
    entry       TEXT,
    enqueued_at INTEGER,
    -- What the runs gave, as JSON; written once, together with the progress.
    piece       TEXT,
    PRIMARY KEY (job_id, number)
) STRICT, WITHOUT ROWID;

CREATE INDEX chunks_to_do ON chunks (state, job_id) WHERE state IN ('queued', 'running');

-- Jobs of an earlier version run as they were queued.
UPDATE jobs SET priority = CASE WHEN kind = 'campaign' THEN 50 ELSE 100 END;
