-- Zones: polygons on a floor, with omlox's tolerances. -1 = for ever.
CREATE TABLE zone (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL CHECK (length(CAST(name AS BLOB)) BETWEEN 1 AND 256),
  floor INTEGER NOT NULL CHECK (floor BETWEEN -100 AND 1000),
  region BLOB NOT NULL,
  exit_tolerance_m REAL NOT NULL CHECK (exit_tolerance_m BETWEEN 0 AND 1000),
  tolerance_timeout_us INTEGER NOT NULL CHECK (tolerance_timeout_us >= -1),
  exit_delay_us INTEGER NOT NULL CHECK (exit_delay_us >= -1),
  timeout_us INTEGER NOT NULL CHECK (timeout_us >= -1)
) STRICT;
