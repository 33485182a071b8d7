-- Jobs that stay whatever room they take, and the order in which others go.
ALTER TABLE jobs ADD COLUMN pinned INTEGER NOT NULL DEFAULT 0;
CREATE INDEX jobs_by_end ON jobs (finished_at, id) WHERE deleted_at IS NULL AND pinned = 0 AND finished_at IS NOT NULL;
