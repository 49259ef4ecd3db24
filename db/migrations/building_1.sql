-- A building: one row, its description and the version its survey has reached.
CREATE TABLE building (
  singleton INTEGER PRIMARY KEY CHECK (singleton = 1),
  id INTEGER NOT NULL CHECK (id > 0),
  name TEXT NOT NULL CHECK (length(CAST(name AS BLOB)) BETWEEN 1 AND 256),
  latitude_deg REAL CHECK (latitude_deg BETWEEN -90 AND 90),
  longitude_deg REAL CHECK (longitude_deg BETWEEN -180 AND 180),
  y_axis_azimuth_rad REAL CHECK (y_axis_azimuth_rad BETWEEN -7 AND 7),
  declination_rad REAL NOT NULL CHECK (declination_rad BETWEEN -4 AND 4),
  dip_rad REAL NOT NULL CHECK (dip_rad BETWEEN -2 AND 2),
  norm_ut REAL NOT NULL CHECK (norm_ut BETWEEN 0 AND 1000),
  pipeline TEXT NOT NULL CHECK (length(pipeline) BETWEEN 1 AND 256),
  survey_version INTEGER NOT NULL CHECK (survey_version >= 0),
  CHECK ((latitude_deg IS NULL) = (longitude_deg IS NULL) AND (latitude_deg IS NULL) = (y_axis_azimuth_rad IS NULL))
) STRICT;

-- Polygons are packed, see db/README.md; an empty blob is an unknown outline.
CREATE TABLE floor (
  ordinal INTEGER PRIMARY KEY CHECK (ordinal BETWEEN -100 AND 1000),
  label TEXT NOT NULL CHECK (length(CAST(label AS BLOB)) <= 256),
  outline BLOB NOT NULL,
  walkable BLOB NOT NULL
) STRICT;

-- One row a stored batch: what makes a retry harmless, and where each point came from.
CREATE TABLE upload (
  id INTEGER PRIMARY KEY,
  idempotency_key TEXT NOT NULL UNIQUE CHECK (length(idempotency_key) BETWEEN 1 AND 64),
  body_hash BLOB NOT NULL CHECK (length(body_hash) = 32),
  stored INTEGER NOT NULL CHECK (stored >= 0),
  survey_version INTEGER NOT NULL CHECK (survey_version > 0)
) STRICT;

CREATE TABLE device_model (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE CHECK (length(CAST(name AS BLOB)) <= 256)
) STRICT;

CREATE TABLE survey_walk (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE CHECK (length(CAST(name AS BLOB)) BETWEEN 1 AND 256)
) STRICT;

CREATE TABLE reference_point (
  id INTEGER PRIMARY KEY,
  upload_id INTEGER NOT NULL REFERENCES upload (id),
  floor INTEGER NOT NULL CHECK (floor BETWEEN -100 AND 1000),
  x_m REAL NOT NULL CHECK (x_m BETWEEN -1e6 AND 1e6),
  y_m REAL NOT NULL CHECK (y_m BETWEEN -1e6 AND 1e6),
  sigma_m REAL NOT NULL CHECK (sigma_m BETWEEN 0 AND 1e4),
  device_model_id INTEGER NOT NULL REFERENCES device_model (id),
  walk_id INTEGER REFERENCES survey_walk (id),
  surveyed_at_us INTEGER NOT NULL
) STRICT;

-- Every raw scan as the phone gave it. `readings` is packed, see db/README.md.
CREATE TABLE scan (
  id INTEGER PRIMARY KEY,
  point_id INTEGER NOT NULL REFERENCES reference_point (id),
  ordinal INTEGER NOT NULL CHECK (ordinal BETWEEN 0 AND 63),
  phone_time_us INTEGER NOT NULL,
  readings BLOB NOT NULL,
  UNIQUE (point_id, ordinal)
) STRICT;

-- What the survey heard of each transmitter; kept in step with `scan` by the same transaction.
CREATE TABLE transmitter (
  bssid INTEGER PRIMARY KEY CHECK (bssid BETWEEN 0 AND 281474976710655),
  frequency_mhz INTEGER NOT NULL CHECK (frequency_mhz BETWEEN 0 AND 65535),
  readings INTEGER NOT NULL CHECK (readings > 0),
  strongest_dbm REAL NOT NULL CHECK (strongest_dbm BETWEEN -120 AND 0),
  first_heard_at_us INTEGER NOT NULL,
  last_heard_at_us INTEGER NOT NULL
) STRICT;
