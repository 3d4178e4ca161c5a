-- Schema 1 of a registry of maps: sites, files, versions of maps, sessions, accounts, events.
-- "byre registry init" and "migrate" apply it in one transaction; docs/reference/registry.md describes it.
CREATE SCHEMA byre;
CREATE TABLE byre.schema_version (
  version int PRIMARY KEY,
  oldest_client int NOT NULL,  -- clients made for an earlier schema are refused
  applied_at timestamptz NOT NULL DEFAULT now()
);

-- Roles belong to the whole server.
DO $$
DECLARE
  role text;
BEGIN
  FOREACH role IN ARRAY ARRAY['byre_robot', 'byre_reviewer', 'byre_worker'] LOOP
    IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = role) THEN
      EXECUTE format('CREATE ROLE %I NOLOGIN', role);
    END IF;
  END LOOP;
END $$;

CREATE TABLE byre.site (
  id int GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  name text NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 200 AND name !~ '[[:cntrl:]]')
);

CREATE TABLE byre.robot (
  account text PRIMARY KEY,
  site int NOT NULL REFERENCES byre.site
);

-- Files, in chunks of 1 MB. A chunk is named by the SHA-256 of its bytes, a file by the SHA-256 of the names of its
-- chunks in order. So the server verifies both, however large a file is, and an upload continues where it stopped.
CREATE TABLE byre.chunk (
  hash bytea PRIMARY KEY,
  data bytea NOT NULL,
  CONSTRAINT chunk_size CHECK (length(data) BETWEEN 1 AND 1048576),
  CONSTRAINT chunk_hash CHECK (hash = sha256(data))
);
ALTER TABLE byre.chunk ALTER data SET STORAGE EXTERNAL;  -- maps are packed already
CREATE TABLE byre.blob (
  hash bytea PRIMARY KEY,
  size bigint NOT NULL
);
CREATE TABLE byre.blob_chunk (
  blob bytea NOT NULL REFERENCES byre.blob,
  number int NOT NULL,
  chunk bytea NOT NULL REFERENCES byre.chunk,
  PRIMARY KEY (blob, number)
);
CREATE INDEX ON byre.blob_chunk (chunk);

CREATE TABLE byre.version (
  site int NOT NULL REFERENCES byre.site,
  id text NOT NULL CHECK (id ~ '^[0-9a-f]{16}$'),  -- of the map file, as in "byre history"
  blob bytea NOT NULL REFERENCES byre.blob,
  parents text[] NOT NULL DEFAULT '{}',  -- versions that it was made of, the newest first
  state text NOT NULL DEFAULT 'proposed' CHECK (state IN ('proposed', 'accepted', 'retired')),
  note text NOT NULL DEFAULT '' CHECK (length(note) <= 1000),
  added_by text NOT NULL DEFAULT current_user,
  added_at timestamptz NOT NULL DEFAULT now(),
  reviewed_by text,
  reason text CHECK (length(reason) <= 1000),
  accepted_at timestamptz,  -- first acceptance
  PRIMARY KEY (site, id)
);
CREATE UNIQUE INDEX version_accepted ON byre.version (site) WHERE state = 'accepted';
CREATE INDEX ON byre.version (blob);

CREATE TABLE byre.session (
  site int NOT NULL REFERENCES byre.site,
  id text NOT NULL CHECK (id ~ '^[0-9a-f]{16}$'),  -- of the session file
  blob bytea NOT NULL REFERENCES byre.blob,
  ran_on text NOT NULL CHECK (ran_on ~ '^[0-9a-f]{16}$'),  -- map
  name text NOT NULL CHECK (length(name) <= 200),
  state text NOT NULL DEFAULT 'open' CHECK (state IN ('open', 'closed')),  -- closed: no update uses it any more
  reason text CHECK (length(reason) <= 1000),
  added_by text NOT NULL DEFAULT current_user,
  added_at timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (site, id)
);
CREATE INDEX ON byre.session (blob);
CREATE INDEX session_open ON byre.session (site, added_at) WHERE state = 'open';

CREATE TABLE byre.event (
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  at timestamptz NOT NULL DEFAULT now(),
  site int NOT NULL REFERENCES byre.site,
  actor text NOT NULL,
  kind text NOT NULL,
  subject text NOT NULL,  -- id of a version or session, number of a job
  reason text NOT NULL DEFAULT ''
);
CREATE INDEX ON byre.event (site, id);

-- Rules that hold for all accounts, the owner included.
CREATE FUNCTION byre.refuse_change() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  RAISE EXCEPTION 'rows of byre.% are neither changed nor removed', TG_TABLE_NAME;
END $$;
DO $$
DECLARE
  kept text;
BEGIN
  FOREACH kept IN ARRAY ARRAY['chunk', 'blob', 'blob_chunk', 'event'] LOOP
    EXECUTE format('CREATE TRIGGER keep BEFORE UPDATE OR DELETE OR TRUNCATE ON byre.%I
                    FOR EACH STATEMENT EXECUTE FUNCTION byre.refuse_change()', kept);
  END LOOP;
  FOREACH kept IN ARRAY ARRAY['version', 'session'] LOOP
    EXECUTE format('CREATE TRIGGER keep BEFORE DELETE OR TRUNCATE ON byre.%I
                    FOR EACH STATEMENT EXECUTE FUNCTION byre.refuse_change()', kept);
  END LOOP;
END $$;

CREATE FUNCTION byre.review_version() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF (NEW.site, NEW.id, NEW.blob, NEW.parents, NEW.note, NEW.added_by, NEW.added_at)
     IS DISTINCT FROM (OLD.site, OLD.id, OLD.blob, OLD.parents, OLD.note, OLD.added_by, OLD.added_at) THEN
    RAISE EXCEPTION 'version % is not changed, only its state', OLD.id;
  END IF;
  IF (OLD.state, NEW.state) NOT IN (('proposed', 'accepted'), ('proposed', 'retired'), ('accepted', 'retired'))
     AND NOT (OLD.state = 'retired' AND NEW.state = 'accepted' AND OLD.accepted_at IS NOT NULL) THEN
    RAISE EXCEPTION 'version % is %, and cannot become %', OLD.id, OLD.state, NEW.state;
  END IF;
  NEW.reviewed_by := current_user;
  NEW.accepted_at := CASE WHEN NEW.state = 'accepted' THEN coalesce(OLD.accepted_at, now()) ELSE OLD.accepted_at END;
  RETURN NEW;
END $$;
CREATE TRIGGER review BEFORE UPDATE ON byre.version FOR EACH ROW EXECUTE FUNCTION byre.review_version();

CREATE FUNCTION byre.close_session() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF (NEW.site, NEW.id, NEW.blob, NEW.ran_on, NEW.name, NEW.added_by, NEW.added_at)
     IS DISTINCT FROM (OLD.site, OLD.id, OLD.blob, OLD.ran_on, OLD.name, OLD.added_by, OLD.added_at) THEN
    RAISE EXCEPTION 'session % is not changed, only its state', OLD.id;
  END IF;
  RETURN NEW;
END $$;
CREATE TRIGGER close BEFORE UPDATE ON byre.session FOR EACH ROW EXECUTE FUNCTION byre.close_session();

-- The id of a map file is a checksum in its header (docs/reference/map_format.md).
CREATE FUNCTION byre.check_file() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = byre, pg_temp AS $$
DECLARE
  head bytea;
  at int;
  stored text := '';
BEGIN
  SELECT substring(c.data FROM 1 FOR 8192) INTO head
    FROM blob_chunk b JOIN chunk c ON c.hash = b.chunk WHERE b.blob = NEW.blob AND b.number = 0;
  IF head IS NULL OR length(head) < 24 OR substring(head FROM 1 FOR 8) <> '\x89425952450d0a1a' THEN
    RAISE EXCEPTION 'the file of % is no map', NEW.id;
  END IF;
  at := 24 + 40 * (get_byte(head, 12) + 256 * get_byte(head, 13));
  IF length(head) >= at + 8 THEN
    SELECT string_agg(lpad(to_hex(get_byte(head, i)), 2, '0'), '' ORDER BY i DESC) INTO stored
      FROM generate_series(at, at + 7) i;
  END IF;
  IF stored <> NEW.id THEN
    RAISE EXCEPTION 'the file has the id %, not %', stored, NEW.id;
  END IF;
  RETURN NULL;
END $$;
CREATE TRIGGER check_file AFTER INSERT ON byre.version FOR EACH ROW EXECUTE FUNCTION byre.check_file();
CREATE TRIGGER check_file AFTER INSERT ON byre.session FOR EACH ROW EXECUTE FUNCTION byre.check_file();

CREATE FUNCTION byre.log_version() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = byre, pg_temp AS $$
BEGIN
  IF TG_OP = 'INSERT' THEN
    INSERT INTO event (site, actor, kind, subject, reason) VALUES (NEW.site, NEW.added_by, 'proposed', NEW.id, NEW.note);
  ELSE
    INSERT INTO event (site, actor, kind, subject, reason)
      VALUES (NEW.site, NEW.reviewed_by, NEW.state, NEW.id, coalesce(NEW.reason, ''));
    IF NEW.state = 'accepted' THEN
      PERFORM pg_notify('byre_accepted', NEW.site::text);
    END IF;
  END IF;
  RETURN NULL;
END $$;
CREATE TRIGGER log AFTER INSERT OR UPDATE ON byre.version FOR EACH ROW EXECUTE FUNCTION byre.log_version();

CREATE FUNCTION byre.log_session() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = byre, pg_temp AS $$
BEGIN
  INSERT INTO event (site, actor, kind, subject, reason) VALUES (NEW.site, NEW.added_by, 'session', NEW.id, NEW.name);
  RETURN NULL;
END $$;
CREATE TRIGGER log AFTER INSERT ON byre.session FOR EACH ROW EXECUTE FUNCTION byre.log_session();

-- Uploads. `chunks`: names of the chunks in order, 32 bytes each.
CREATE FUNCTION byre.missing_chunks(chunks bytea) RETURNS SETOF int
  LANGUAGE sql STABLE SECURITY DEFINER SET search_path = byre, pg_temp AS $$
  SELECT n FROM generate_series(0, length(chunks) / 32 - 1) n
    WHERE NOT EXISTS (SELECT FROM chunk WHERE hash = substring(chunks FROM n * 32 + 1 FOR 32)) ORDER BY n
$$;
CREATE FUNCTION byre.add_blob(chunks bytea) RETURNS bytea
  LANGUAGE plpgsql SECURITY DEFINER SET search_path = byre, pg_temp AS $$
DECLARE
  name bytea := sha256(chunks);
BEGIN
  IF length(chunks) = 0 OR length(chunks) % 32 <> 0 OR EXISTS (SELECT FROM missing_chunks(chunks)) THEN
    RAISE EXCEPTION 'a file lacks some of its chunks' USING HINT = 'push it again';
  END IF;
  INSERT INTO blob SELECT name, sum(length(c.data)) FROM generate_series(0, length(chunks) / 32 - 1) n
    JOIN chunk c ON c.hash = substring(chunks FROM n * 32 + 1 FOR 32) ON CONFLICT DO NOTHING;
  IF FOUND THEN
    INSERT INTO blob_chunk SELECT name, n, substring(chunks FROM n * 32 + 1 FOR 32)
      FROM generate_series(0, length(chunks) / 32 - 1) n;
  END IF;
  RETURN name;
END $$;

-- Reviews.
CREATE FUNCTION byre.replace_accepted(at_site int, present text, why_retired text, wanted text, why text) RETURNS void
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
BEGIN
  UPDATE version SET state = 'retired', reason = why_retired
    WHERE site = at_site AND id = present AND state = 'accepted';
  UPDATE version SET state = 'accepted', reason = why WHERE site = at_site AND id = wanted;
EXCEPTION WHEN unique_violation THEN
  RAISE EXCEPTION 'another version was accepted at the same time' USING HINT = 'compare with it, and try again';
END $$;

CREATE FUNCTION byre.accept(at_site int, wanted text, why text) RETURNS void
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
DECLARE
  made_of text[];
  present text;
BEGIN
  SELECT parents INTO made_of FROM version WHERE site = at_site AND id = wanted AND state = 'proposed';
  IF NOT FOUND THEN
    RAISE EXCEPTION 'version % is not proposed', wanted USING HINT = 'byre registry list SITE shows the states';
  END IF;
  SELECT id INTO present FROM version WHERE site = at_site AND state = 'accepted';
  IF cardinality(made_of) > 0 AND present IS NOT NULL AND NOT present = ANY (made_of) THEN
    RAISE EXCEPTION 'version % was not made of %, which is accepted', wanted, present
      USING HINT = 'reject it; the next update is made of the accepted version';
  END IF;
  PERFORM replace_accepted(at_site, present, 'replaced by ' || wanted, wanted, why);
END $$;

CREATE FUNCTION byre.reject(at_site int, wanted text, why text) RETURNS void
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
BEGIN
  UPDATE version SET state = 'retired', reason = why WHERE site = at_site AND id = wanted AND state = 'proposed';
  IF NOT FOUND THEN
    RAISE EXCEPTION 'version % is not proposed', wanted USING HINT = 'byre registry rollback replaces an accepted one';
  END IF;
END $$;

-- Accepts an earlier version again; by default the one accepted before the present one. Returns its id.
CREATE FUNCTION byre.rollback(at_site int, wanted text, why text) RETURNS text
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
DECLARE
  present version;
  chosen text;
BEGIN
  SELECT * INTO present FROM version WHERE site = at_site AND state = 'accepted';
  SELECT id INTO chosen FROM version
    WHERE site = at_site AND state = 'retired' AND accepted_at IS NOT NULL
      AND CASE WHEN wanted IS NULL THEN accepted_at < present.accepted_at ELSE id = wanted END
    ORDER BY accepted_at DESC LIMIT 1;
  IF NOT FOUND THEN
    RAISE EXCEPTION 'there is no earlier accepted version%', coalesce(' ' || wanted, '')
      USING HINT = 'byre registry history SITE shows what was accepted';
  END IF;
  PERFORM replace_accepted(at_site, present.id, why, chosen, why);
  RETURN chosen;
END $$;

-- Gives an account a role, and creates it without a password if missing. Needs the right to create roles.
CREATE FUNCTION byre.admit(wanted text, role text, at_site int) RETURNS void
  LANGUAGE plpgsql SET search_path = byre, pg_temp AS $$
BEGIN
  IF role NOT IN ('robot', 'reviewer', 'worker') OR (role = 'robot') <> (at_site IS NOT NULL) THEN
    RAISE EXCEPTION 'a robot has a site, a reviewer and a worker have none';
  END IF;
  IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = wanted) THEN
    EXECUTE format('CREATE ROLE %I LOGIN', wanted);
  END IF;
  EXECUTE format('GRANT %I TO %I', 'byre_' || role, wanted);
  IF role = 'robot' THEN
    INSERT INTO robot VALUES (wanted, at_site) ON CONFLICT (account) DO UPDATE SET site = excluded.site;
  END IF;
END $$;

-- Access. Accounts read and write what is granted here and permitted by a policy.
REVOKE EXECUTE ON ALL FUNCTIONS IN SCHEMA byre FROM PUBLIC;
GRANT USAGE ON SCHEMA byre TO byre_robot, byre_reviewer, byre_worker;
GRANT EXECUTE ON FUNCTION byre.missing_chunks, byre.add_blob TO byre_robot, byre_reviewer, byre_worker;
GRANT EXECUTE ON FUNCTION byre.accept, byre.reject, byre.rollback, byre.replace_accepted TO byre_reviewer;
GRANT SELECT ON byre.schema_version, byre.site, byre.robot, byre.chunk, byre.blob, byre.blob_chunk, byre.version,
  byre.session TO byre_robot, byre_reviewer, byre_worker;
GRANT SELECT ON byre.event TO byre_robot, byre_reviewer, byre_worker;  -- no policy lets a robot read a row
GRANT INSERT ON byre.chunk TO byre_robot, byre_reviewer, byre_worker;
GRANT INSERT (site, id, blob, parents, note) ON byre.version TO byre_reviewer, byre_worker;
GRANT INSERT (site, id, blob, ran_on, name) ON byre.session TO byre_robot, byre_reviewer;
GRANT UPDATE (state, reason) ON byre.version TO byre_reviewer, byre_worker;
GRANT UPDATE (state, reason) ON byre.session TO byre_worker;

DO $$
DECLARE
  guarded text;
BEGIN
  FOREACH guarded IN ARRAY ARRAY['site', 'robot', 'chunk', 'blob', 'blob_chunk', 'version', 'session', 'event'] LOOP
    EXECUTE format('ALTER TABLE byre.%I ENABLE ROW LEVEL SECURITY', guarded);
    EXECUTE format('CREATE POLICY read_all ON byre.%I FOR SELECT TO byre_reviewer, byre_worker USING (true)', guarded);
  END LOOP;
END $$;
CREATE POLICY read_own ON byre.robot FOR SELECT TO byre_robot USING (account = current_user);
CREATE POLICY read_own ON byre.site FOR SELECT TO byre_robot USING (
  id = (SELECT r.site FROM byre.robot r WHERE r.account = current_user));
CREATE POLICY read_accepted ON byre.version FOR SELECT TO byre_robot USING (
  state = 'accepted' AND site = (SELECT r.site FROM byre.robot r WHERE r.account = current_user));
CREATE POLICY read_own ON byre.session FOR SELECT TO byre_robot USING (
  site = (SELECT r.site FROM byre.robot r WHERE r.account = current_user));
CREATE POLICY add_own ON byre.session FOR INSERT TO byre_robot WITH CHECK (
  site = (SELECT r.site FROM byre.robot r WHERE r.account = current_user));
-- A robot reads the files of the versions and sessions that it reads: the policies above hold in these too.
CREATE POLICY read_listed ON byre.blob FOR SELECT TO byre_robot USING (
  EXISTS (SELECT FROM byre.version v WHERE v.blob = hash) OR EXISTS (SELECT FROM byre.session s WHERE s.blob = hash));
CREATE POLICY read_listed ON byre.blob_chunk FOR SELECT TO byre_robot USING (
  EXISTS (SELECT FROM byre.version v WHERE v.blob = blob_chunk.blob)
  OR EXISTS (SELECT FROM byre.session s WHERE s.blob = blob_chunk.blob));
CREATE POLICY read_listed ON byre.chunk FOR SELECT TO byre_robot USING (
  EXISTS (SELECT FROM byre.blob_chunk b WHERE b.chunk = hash));
CREATE POLICY add ON byre.chunk FOR INSERT TO byre_robot, byre_reviewer, byre_worker WITH CHECK (true);
CREATE POLICY add ON byre.version FOR INSERT TO byre_reviewer, byre_worker WITH CHECK (state = 'proposed');
CREATE POLICY add ON byre.session FOR INSERT TO byre_reviewer WITH CHECK (true);
CREATE POLICY review ON byre.version FOR UPDATE TO byre_reviewer USING (true);
CREATE POLICY supersede ON byre.version FOR UPDATE TO byre_worker USING (state = 'proposed') WITH CHECK (state = 'retired');
CREATE POLICY close ON byre.session FOR UPDATE TO byre_worker USING (true);
