-- How maps come into force: by themselves, or only by an operator's word.
ALTER TABLE building ADD COLUMN publication TEXT NOT NULL DEFAULT 'automatic' CHECK (publication IN ('automatic', 'reviewed'));

-- Figures of a walk a map never answers on count too; with which pipeline they were measured (name and settings, hashed), how
-- often it was asked, and the errors' 0 to 100 % quantiles (f32 little endian, metres).
CREATE TABLE map_quality_new (
  version INTEGER NOT NULL REFERENCES radio_map (version) ON DELETE CASCADE,
  walk_id INTEGER NOT NULL REFERENCES quality_walk (id) ON DELETE CASCADE,
  measured_at_us INTEGER NOT NULL,
  measured_with TEXT NOT NULL,
  asked INTEGER NOT NULL CHECK (asked > 0),
  instants INTEGER NOT NULL CHECK (instants BETWEEN 0 AND asked),
  mean_m REAL NOT NULL CHECK (mean_m >= 0),
  rmse_m REAL NOT NULL CHECK (rmse_m >= 0),
  median_m REAL NOT NULL CHECK (median_m >= 0),
  p90_m REAL NOT NULL CHECK (p90_m >= 0),
  floor_hit REAL NOT NULL CHECK (floor_hit BETWEEN 0 AND 1),
  in68 REAL NOT NULL CHECK (in68 BETWEEN 0 AND 1),
  in95 REAL NOT NULL CHECK (in95 BETWEEN 0 AND 1),
  error_quantiles_m BLOB NOT NULL CHECK (length(error_quantiles_m) IN (0, 404)),
  PRIMARY KEY (version, walk_id)
) STRICT, WITHOUT ROWID;
INSERT INTO map_quality_new SELECT version, walk_id, measured_at_us, '', instants, instants, mean_m, rmse_m, median_m, p90_m, floor_hit,
  in68, in95, x'' FROM map_quality;
DROP TABLE map_quality;
ALTER TABLE map_quality_new RENAME TO map_quality;

-- What live traffic says of access points, and what the operator says about that. No positions of phones.
CREATE TABLE access_point (
  bssid INTEGER PRIMARY KEY CHECK (bssid BETWEEN 0 AND 281474976710655),
  trust TEXT NOT NULL CHECK (trust IN ('auto', 'always', 'never')),
  state TEXT NOT NULL CHECK (state IN ('ok', 'vanished', 'moved', 'power_changed', 'new')),
  reason TEXT NOT NULL CHECK (length(CAST(reason AS BLOB)) <= 1024),
  heard_sessions INTEGER NOT NULL CHECK (heard_sessions >= 0),
  last_heard_at_us INTEGER,
  distance_m REAL CHECK (distance_m >= 0),
  change_db REAL CHECK (change_db BETWEEN -200 AND 200),
  decided_at_us INTEGER NOT NULL
) STRICT;

-- Survey walks as they were recorded, part by part; `content` is the survey_walk message as CBOR.
CREATE TABLE walk_part (
  id INTEGER PRIMARY KEY,
  idempotency_key TEXT NOT NULL UNIQUE CHECK (length(idempotency_key) BETWEEN 1 AND 64),
  walk TEXT NOT NULL CHECK (length(CAST(walk AS BLOB)) BETWEEN 1 AND 256),
  part INTEGER NOT NULL CHECK (part BETWEEN 0 AND 9999),
  last INTEGER NOT NULL CHECK (last IN (0, 1)),
  scans INTEGER NOT NULL CHECK (scans >= 0),
  survey_version INTEGER NOT NULL CHECK (survey_version >= 0),
  placed INTEGER NOT NULL DEFAULT 0 CHECK (placed IN (0, 1)),
  sha256 BLOB NOT NULL CHECK (length(sha256) = 32),
  content BLOB NOT NULL,
  UNIQUE (walk, part)
) STRICT;
