-- Schema 4 of a registry of maps: jobs that map a recording, or summarise a version.
ALTER TABLE byre.job
  DROP CONSTRAINT job_kind_check,
  DROP CONSTRAINT job_check,
  ADD recording text NOT NULL DEFAULT '',    -- map: path that workers read
  ADD calibration text NOT NULL DEFAULT '',  -- map: path of another calibration than that of the recording
  ADD keyframes int NOT NULL DEFAULT 0,      -- summarise: keyframes that a place keeps
  ADD CONSTRAINT job_kind CHECK (kind IN ('update', 'merge', 'map', 'summarise')),
  ADD CONSTRAINT job_maps CHECK (cardinality(maps) = CASE kind WHEN 'merge' THEN 2 WHEN 'summarise' THEN 1 ELSE 0 END),
  ADD CONSTRAINT job_recording CHECK ((kind = 'map') = (recording <> '') AND (kind = 'map' OR calibration = '')),
  ADD CONSTRAINT job_keyframes CHECK ((kind = 'summarise') = (keyframes > 0));

-- Takes the job of these kinds that is due first, of a site without a running job. No row: none is due. The number of
-- attempts is the key to end it: a worker that lost its lease has an earlier one.
CREATE FUNCTION byre.take_job(taker text, lease interval, most int, kinds text[]) RETURNS SETOF byre.job
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
DECLARE
  found_job job;
BEGIN
  LOOP
    SELECT * INTO found_job FROM job j
      WHERE j.state IN ('waiting', 'running') AND j.due <= now() AND j.kind = ANY (kinds)
        AND (j.state = 'running' OR NOT EXISTS (SELECT FROM job r WHERE r.site = j.site AND r.state = 'running'))
      ORDER BY j.due, j.id LIMIT 1 FOR UPDATE SKIP LOCKED;
    IF NOT FOUND THEN
      RETURN;
    END IF;
    IF found_job.attempts >= most THEN
      UPDATE job SET state = 'failed', ended_at = now(), message = 'no attempt ended; the last by ' || worker
        WHERE id = found_job.id;
      CONTINUE;
    END IF;
    BEGIN
      RETURN QUERY UPDATE job SET state = 'running', worker = taker, attempts = attempts + 1, due = now() + lease
        WHERE id = found_job.id RETURNING *;
      RETURN;
    EXCEPTION WHEN unique_violation THEN
      NULL;  -- another worker took a job of the site
    END;
  END LOOP;
END $$;

-- For workers of earlier schemas, which run all kinds but merges as updates.
CREATE OR REPLACE FUNCTION byre.take_job(taker text, lease interval, most int) RETURNS SETOF byre.job
  LANGUAGE sql SET search_path = byre, pg_temp AS $$
  SELECT * FROM take_job(taker, lease, most, ARRAY['update', 'merge']);
$$;

REVOKE EXECUTE ON FUNCTION byre.take_job(text, interval, int, text[]) FROM PUBLIC;
GRANT EXECUTE ON FUNCTION byre.take_job(text, interval, int, text[]) TO byre_worker;
GRANT INSERT (recording, calibration, keyframes) ON byre.job TO byre_reviewer;
