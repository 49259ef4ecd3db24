-- When a building was backed up or verified, and what that gave. The newest 100 of each a building; they outlive the building's own file.
CREATE TABLE upkeep (
  id INTEGER PRIMARY KEY,
  building INTEGER NOT NULL CHECK (building > 0),
  kind INTEGER NOT NULL CHECK (kind BETWEEN 0 AND 1),
  at_us INTEGER NOT NULL,
  key_id INTEGER NOT NULL CHECK (key_id >= 0),
  survey_version INTEGER NOT NULL CHECK (survey_version >= 0),
  bytes INTEGER NOT NULL CHECK (bytes >= 0),
  finding TEXT NOT NULL CHECK (length(CAST(finding AS BLOB)) <= 1024)
) STRICT;
CREATE INDEX upkeep_by_building ON upkeep (building, kind, id);
