-- Schema 2 of a registry of maps: jobs of workers.
CREATE TABLE byre.job (
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  site int NOT NULL REFERENCES byre.site,
  kind text NOT NULL CHECK (kind IN ('update', 'merge')),
  maps text[] NOT NULL DEFAULT '{}' CHECK (cardinality(maps) = CASE kind WHEN 'merge' THEN 2 ELSE 0 END),
  -- failed: set aside after too many attempts
  state text NOT NULL DEFAULT 'waiting' CHECK (state IN ('waiting', 'running', 'done', 'failed')),
  due timestamptz NOT NULL DEFAULT now(),  -- waiting: earliest start; running: end of the lease
  attempts int NOT NULL DEFAULT 0,
  worker text,
  result text,  -- id of the version made; null: none
  message text NOT NULL DEFAULT '',
  added_by text NOT NULL DEFAULT current_user,
  added_at timestamptz NOT NULL DEFAULT now(),
  ended_at timestamptz
);
CREATE UNIQUE INDEX job_running ON byre.job (site) WHERE state = 'running';  -- one at a time for each site
CREATE UNIQUE INDEX job_new ON byre.job (site) WHERE kind = 'update' AND state = 'waiting' AND attempts = 0;
CREATE INDEX job_due ON byre.job (due, id) WHERE state IN ('waiting', 'running');
CREATE INDEX ON byre.job (site, id);

-- Sessions that a version was made of, as an update.
CREATE TABLE byre.version_session (
  site int NOT NULL,
  version text NOT NULL,
  session text NOT NULL,
  PRIMARY KEY (site, version, session),
  FOREIGN KEY (site, version) REFERENCES byre.version,
  FOREIGN KEY (site, session) REFERENCES byre.session
);
CREATE TRIGGER keep BEFORE UPDATE OR DELETE OR TRUNCATE ON byre.version_session
  FOR EACH STATEMENT EXECUTE FUNCTION byre.refuse_change();

-- A session waits for an update of its site. The lock delays workers until the session can be seen.
CREATE FUNCTION byre.request_update() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
  SET search_path = byre, pg_temp AS $$
BEGIN
  LOOP
    INSERT INTO job (site, kind, added_by) VALUES (NEW.site, 'update', NEW.added_by) ON CONFLICT DO NOTHING;
    IF NOT FOUND THEN
      PERFORM FROM job WHERE site = NEW.site AND kind = 'update' AND state = 'waiting' AND attempts = 0 FOR KEY SHARE;
    END IF;
    EXIT WHEN FOUND;
  END LOOP;
  PERFORM pg_notify('byre_job', '');
  RETURN NULL;
END $$;
CREATE TRIGGER request_update AFTER INSERT ON byre.session FOR EACH ROW EXECUTE FUNCTION byre.request_update();

-- The sessions of an update stay open until it is accepted or rejected, so that the next update has them too.
CREATE FUNCTION byre.close_sessions() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
  SET search_path = byre, pg_temp AS $$
BEGIN
  UPDATE session s SET state = 'closed', reason = NEW.state || ' with ' || NEW.id
    FROM version_session used
    WHERE used.site = NEW.site AND used.version = NEW.id AND s.site = NEW.site AND s.id = used.session
      AND s.state = 'open';
  RETURN NULL;
END $$;
CREATE TRIGGER close_sessions AFTER UPDATE ON byre.version FOR EACH ROW
  WHEN (OLD.state = 'proposed' AND NEW.state <> OLD.state AND coalesce(NEW.reason, '') NOT LIKE 'superseded by %')
  EXECUTE FUNCTION byre.close_sessions();

CREATE FUNCTION byre.log_job() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = byre, pg_temp AS $$
BEGIN
  INSERT INTO event (site, actor, kind, subject, reason)
    VALUES (NEW.site, coalesce(NEW.worker, NEW.added_by), NEW.kind || ' ' || NEW.state, NEW.id::text, NEW.message);
  RETURN NULL;
END $$;
CREATE TRIGGER log AFTER UPDATE ON byre.job FOR EACH ROW
  WHEN (NEW.state IN ('done', 'failed') AND NEW.state <> OLD.state) EXECUTE FUNCTION byre.log_job();

-- Takes the job that is due first, of a site without a running job. No row: none is due. The number of attempts is the
-- key to end it: a worker that lost its lease has an earlier one.
CREATE FUNCTION byre.take_job(taker text, lease interval, most int) RETURNS SETOF byre.job
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
DECLARE
  found_job job;
BEGIN
  LOOP
    SELECT * INTO found_job FROM job j
      WHERE j.state IN ('waiting', 'running') AND j.due <= now()
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

-- Ends an attempt that failed: waits longer each time, and is set aside after the last. False if the lease was lost.
CREATE FUNCTION byre.fail_job(failed bigint, attempt int, most int, why text) RETURNS boolean
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
BEGIN
  UPDATE job SET message = why,
      state = CASE WHEN attempts < most THEN 'waiting' ELSE 'failed' END,
      ended_at = CASE WHEN attempts < most THEN NULL ELSE now() END,
      due = now() + least(interval '1 hour', interval '10 s' * 2 ^ (attempts - 1))
    WHERE id = failed AND attempts = attempt AND state = 'running';
  RETURN FOUND;
END $$;

REVOKE EXECUTE ON FUNCTION byre.request_update, byre.close_sessions, byre.log_job, byre.take_job, byre.fail_job
  FROM PUBLIC;
GRANT EXECUTE ON FUNCTION byre.take_job, byre.fail_job TO byre_worker;
GRANT SELECT ON byre.job, byre.version_session TO byre_robot, byre_reviewer, byre_worker;  -- a robot reads no row
GRANT INSERT (site, kind, maps) ON byre.job TO byre_reviewer;
GRANT UPDATE (state, due, attempts, worker, result, message, ended_at) ON byre.job TO byre_worker;
GRANT INSERT ON byre.version_session TO byre_worker;
ALTER TABLE byre.job ENABLE ROW LEVEL SECURITY;
ALTER TABLE byre.version_session ENABLE ROW LEVEL SECURITY;
CREATE POLICY read_all ON byre.job FOR SELECT TO byre_reviewer, byre_worker USING (true);
CREATE POLICY read_all ON byre.version_session FOR SELECT TO byre_reviewer, byre_worker USING (true);
CREATE POLICY request ON byre.job FOR INSERT TO byre_reviewer WITH CHECK (state = 'waiting');
CREATE POLICY run ON byre.job FOR UPDATE TO byre_worker USING (true);
CREATE POLICY add ON byre.version_session FOR INSERT TO byre_worker WITH CHECK (true);

-- Sessions of schema 1.
INSERT INTO byre.job (site, kind) SELECT DISTINCT site, 'update' FROM byre.session WHERE state = 'open';
