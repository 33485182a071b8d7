-- What the tracks of the job of a closed session were called while it was open, as JSON.
ALTER TABLE sessions ADD COLUMN track_ids TEXT;
