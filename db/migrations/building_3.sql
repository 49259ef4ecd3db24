-- Radio maps as versions: made once, never changed. Which one is live is the newest publication.
CREATE TABLE radio_map (
  version INTEGER PRIMARY KEY AUTOINCREMENT,
  survey_version INTEGER NOT NULL CHECK (survey_version >= 0),
  recipe TEXT NOT NULL CHECK (length(CAST(recipe AS BLOB)) <= 65536),
  built_at_us INTEGER NOT NULL,
  sha256 BLOB NOT NULL UNIQUE CHECK (length(sha256) = 32),
  content BLOB NOT NULL
) STRICT;
CREATE TRIGGER radio_map_is_immutable BEFORE UPDATE ON radio_map
BEGIN
  SELECT RAISE(ABORT, 'a radio map is never changed');
END;

CREATE TABLE publication (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  version INTEGER NOT NULL REFERENCES radio_map (version),
  act TEXT NOT NULL CHECK (act IN ('promoted', 'rolled back')),
  at_us INTEGER NOT NULL,
  by_key INTEGER NOT NULL CHECK (by_key >= 0),
  reason TEXT NOT NULL CHECK (length(CAST(reason AS BLOB)) <= 1024)
) STRICT;
CREATE TRIGGER publication_is_history BEFORE UPDATE ON publication
BEGIN
  SELECT RAISE(ABORT, 'history is never changed');
END;

-- A recorded walk with its truth, to measure maps by.
CREATE TABLE quality_walk (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL UNIQUE CHECK (length(CAST(name AS BLOB)) BETWEEN 1 AND 256),
  device_model TEXT NOT NULL CHECK (length(CAST(device_model AS BLOB)) <= 256),
  recorded_at_us INTEGER NOT NULL,
  sha256 BLOB NOT NULL UNIQUE CHECK (length(sha256) = 32),
  content BLOB NOT NULL
) STRICT;

CREATE TABLE map_quality (
  version INTEGER NOT NULL REFERENCES radio_map (version) ON DELETE CASCADE,
  walk_id INTEGER NOT NULL REFERENCES quality_walk (id) ON DELETE CASCADE,
  measured_at_us INTEGER NOT NULL,
  instants INTEGER NOT NULL CHECK (instants > 0),
  mean_m REAL NOT NULL CHECK (mean_m >= 0),
  rmse_m REAL NOT NULL CHECK (rmse_m >= 0),
  median_m REAL NOT NULL CHECK (median_m >= 0),
  p90_m REAL NOT NULL CHECK (p90_m >= 0),
  floor_hit REAL NOT NULL CHECK (floor_hit BETWEEN 0 AND 1),
  in68 REAL NOT NULL CHECK (in68 BETWEEN 0 AND 1),
  in95 REAL NOT NULL CHECK (in95 BETWEEN 0 AND 1),
  PRIMARY KEY (version, walk_id)
) STRICT, WITHOUT ROWID;
