-- What keys allow. A key itself is the HMAC of its id under the master key, which is nowhere in the tables.
CREATE TABLE keys (
    id TEXT PRIMARY KEY,
    name TEXT NOT NULL,
    -- JSON list.
    actions TEXT NOT NULL,
    requests_per_minute BIGINT,
    created_at BIGINT NOT NULL,
    expires_at BIGINT,
    revoked_at BIGINT
);
