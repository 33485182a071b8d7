-- The axes of a bearing-time record whose file does not have them, as JSON.
ALTER TABLE datasets ADD COLUMN bearing_time TEXT NOT NULL DEFAULT 'null';
