-- Walls as lines, packed like polygons: one polygon whose rings are open lines. An empty blob = none are known.
ALTER TABLE floor ADD COLUMN walls BLOB NOT NULL DEFAULT x'';

-- The picture of a floor as it came, and where it lies: its lower left corner, the direction of its upward edge.
CREATE TABLE floor_image (
  ordinal INTEGER PRIMARY KEY CHECK (ordinal BETWEEN -100 AND 1000),
  media_type TEXT NOT NULL CHECK (media_type IN ('image/png', 'image/jpeg')),
  width_px INTEGER NOT NULL CHECK (width_px > 0),
  height_px INTEGER NOT NULL CHECK (height_px > 0),
  origin_x_m REAL NOT NULL CHECK (origin_x_m BETWEEN -1e6 AND 1e6),
  origin_y_m REAL NOT NULL CHECK (origin_y_m BETWEEN -1e6 AND 1e6),
  width_m REAL NOT NULL CHECK (width_m > 0 AND width_m <= 1e5),
  height_m REAL NOT NULL CHECK (height_m > 0 AND height_m <= 1e5),
  azimuth_rad REAL NOT NULL CHECK (azimuth_rad BETWEEN -7 AND 7),
  content BLOB NOT NULL
) STRICT;

-- Where zone events are posted to. The secret signs them: 32 random bytes.
CREATE TABLE webhook (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  url TEXT NOT NULL CHECK (length(CAST(url AS BLOB)) BETWEEN 1 AND 2048),
  secret BLOB NOT NULL CHECK (length(secret) = 32),
  zones TEXT NOT NULL CHECK (length(CAST(zones AS BLOB)) <= 65536),
  enabled INTEGER NOT NULL CHECK (enabled IN (0, 1)),
  created_at_us INTEGER NOT NULL
) STRICT;
