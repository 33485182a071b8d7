-- What the format of a file was told, as JSON by name, in the place of the one option of one format.
ALTER TABLE datasets ADD COLUMN format_options TEXT NOT NULL DEFAULT '{}';
UPDATE datasets SET format_options = '{"bearing_time":' || bearing_time || '}' WHERE bearing_time <> 'null';
ALTER TABLE datasets DROP COLUMN bearing_time;
