-- Who did or read what, when. Never a position, a token or a person; rows go only by retention.
CREATE TABLE audit (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  at_us INTEGER NOT NULL,
  key_id INTEGER NOT NULL CHECK (key_id >= 0),
  building INTEGER NOT NULL CHECK (building >= 0),
  action TEXT NOT NULL CHECK (length(CAST(action AS BLOB)) BETWEEN 1 AND 64),
  subject TEXT NOT NULL CHECK (length(CAST(subject AS BLOB)) <= 256)
) STRICT;
CREATE INDEX audit_by_time ON audit (at_us);
CREATE TRIGGER audit_is_history BEFORE UPDATE ON audit
BEGIN
  SELECT RAISE(ABORT, 'history is never changed');
END;
