-- Files of jobs that may not be on the disk by themselves yet: written in the same change that names them, gone when they are.
CREATE TABLE unsynced_blobs (
    id       TEXT PRIMARY KEY,
    sha256   TEXT NOT NULL,
    owner    TEXT NOT NULL,
    content  BLOB NOT NULL,
    noted_at INTEGER NOT NULL
) STRICT;
