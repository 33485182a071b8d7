-- The queue: what has to be looked at, and which worker looks at it. An entry without a worker waits.
CREATE TABLE queue (
    id     TEXT COLLATE "C" PRIMARY KEY,
    job_id TEXT NOT NULL,
    chunk  BIGINT,
    -- Greater goes first.
    place  BIGINT NOT NULL,
    worker TEXT
);

CREATE INDEX queue_waiting ON queue (place DESC, id) WHERE worker IS NULL;
CREATE INDEX queue_by_worker ON queue (worker) WHERE worker IS NOT NULL;
CREATE INDEX queue_by_work ON queue (job_id, chunk);

CREATE TABLE workers (
    id        TEXT PRIMARY KEY,
    last_seen TIMESTAMPTZ NOT NULL
);

-- What an earlier version had in its own queue: what waits is put in again, what ran is looked at through its entry, as after a crash.
UPDATE jobs SET enqueued_at = NULL WHERE state = 'queued';
UPDATE chunks SET enqueued_at = NULL WHERE state = 'queued';
INSERT INTO queue (id, job_id, chunk, place)
    SELECT entry, id, NULL, priority * 1000000 FROM jobs
    WHERE state = 'running' AND entry IS NOT NULL AND id NOT IN (SELECT job_id FROM campaigns);
INSERT INTO queue (id, job_id, chunk, place)
    SELECT entry, job_id, number, 0 FROM chunks WHERE state = 'running' AND entry IS NOT NULL;

-- Files of jobs that may not be on the disk by themselves yet: written in the same change that names them, gone when they are.
CREATE TABLE unsynced_blobs (
    id       TEXT COLLATE "C" PRIMARY KEY,
    sha256   TEXT NOT NULL,
    owner    TEXT NOT NULL,
    content  BYTEA NOT NULL,
    noted_at BIGINT NOT NULL
);

CREATE INDEX unsynced_blobs_by_owner ON unsynced_blobs (owner, id);
