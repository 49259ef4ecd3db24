-- What POSTs with an idempotency key were answered, for a day. Never an answer that holds a secret.
CREATE TABLE answered_post (
  name TEXT PRIMARY KEY CHECK (length(name) BETWEEN 1 AND 128),
  body_hash TEXT NOT NULL CHECK (length(body_hash) BETWEEN 1 AND 128),
  at_us INTEGER NOT NULL,
  state INTEGER NOT NULL CHECK (state BETWEEN 0 AND 2),
  answer BLOB
) STRICT, WITHOUT ROWID;
CREATE INDEX answered_post_by_time ON answered_post (at_us);
