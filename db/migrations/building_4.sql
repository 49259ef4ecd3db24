-- What a pipeline learnt from the survey's walks, one row a pipeline. The content holds its own provenance.
CREATE TABLE corrector (
  pipeline TEXT PRIMARY KEY CHECK (length(CAST(pipeline AS BLOB)) BETWEEN 1 AND 256),
  survey_version INTEGER NOT NULL CHECK (survey_version >= 0),
  content TEXT NOT NULL CHECK (length(CAST(content AS BLOB)) BETWEEN 1 AND 1000000)
) STRICT;
