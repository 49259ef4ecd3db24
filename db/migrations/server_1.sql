-- Keys the hashes of api_key; made once, never shown.
CREATE TABLE secret (
  singleton INTEGER PRIMARY KEY CHECK (singleton = 1),
  value BLOB NOT NULL CHECK (length(value) = 32)
) STRICT;

CREATE TABLE api_key (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL CHECK (length(CAST(name AS BLOB)) BETWEEN 1 AND 256),
  keyed_hash BLOB NOT NULL UNIQUE CHECK (length(keyed_hash) = 32),
  building INTEGER NOT NULL CHECK (building >= 0),
  created_at_us INTEGER NOT NULL,
  expires_at_us INTEGER,
  revoked INTEGER NOT NULL DEFAULT 0 CHECK (revoked IN (0, 1))
) STRICT;

CREATE TABLE api_key_scope (
  key_id INTEGER NOT NULL REFERENCES api_key (id),
  scope TEXT NOT NULL CHECK (scope IN ('survey', 'track', 'observe', 'admin')),
  PRIMARY KEY (key_id, scope)
) STRICT, WITHOUT ROWID;
