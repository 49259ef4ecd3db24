-- A key may be held to zones: it never sees a coordinate.
ALTER TABLE api_key ADD COLUMN coarse INTEGER NOT NULL DEFAULT 0 CHECK (coarse IN (0, 1));

-- Numbers of buildings that were removed: never given again, for keys and audit speak of them.
CREATE TABLE removed_building (
  id INTEGER PRIMARY KEY CHECK (id > 0),
  at_us INTEGER NOT NULL
) STRICT;
