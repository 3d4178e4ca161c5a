-- Schema 5 of a registry of maps: floor plans of a site, by name. The newest one of a name is the current one.
CREATE TABLE byre.plan (
  site int NOT NULL REFERENCES byre.site,
  name text NOT NULL CHECK (length(name) BETWEEN 1 AND 200 AND name !~ '[[:cntrl:]]'),  -- of a floor or a building
  number int NOT NULL,  -- from 1, counted by a trigger
  file text NOT NULL,   -- that commands read: YAML file of map_server, or image
  blob bytea NOT NULL REFERENCES byre.blob,
  other_file text NOT NULL,  -- its image or world file, in the same folder
  other_blob bytea NOT NULL REFERENCES byre.blob,
  note text NOT NULL DEFAULT '' CHECK (length(note) <= 1000),
  added_by text NOT NULL DEFAULT current_user,
  added_at timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (site, name, number),
  CONSTRAINT plan_files CHECK (file <> other_file AND file ~ '^[^./[:cntrl:]][^/[:cntrl:]]{0,199}$'
    AND other_file ~ '^[^./[:cntrl:]][^/[:cntrl:]]{0,199}$')
);
CREATE INDEX ON byre.plan (blob);
CREATE INDEX ON byre.plan (other_blob);
CREATE TRIGGER keep BEFORE UPDATE OR DELETE OR TRUNCATE ON byre.plan
  FOR EACH STATEMENT EXECUTE FUNCTION byre.refuse_change();

-- Numbers a plan, and skips one that is the current one already. A map names its plan by the file, so two current plans
-- of a site have different ones.
CREATE FUNCTION byre.number_plan() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = byre, pg_temp AS $$
DECLARE
  present plan;
  same text;
BEGIN
  PERFORM FROM site WHERE id = NEW.site FOR NO KEY UPDATE;  -- one plan of a site at a time
  SELECT * INTO present FROM plan WHERE site = NEW.site AND name = NEW.name ORDER BY number DESC LIMIT 1;
  IF (NEW.file, NEW.blob, NEW.other_file, NEW.other_blob)
     IS NOT DISTINCT FROM (present.file, present.blob, present.other_file, present.other_blob) THEN
    RETURN NULL;
  END IF;
  SELECT p.name INTO same FROM plan p WHERE p.site = NEW.site AND p.name <> NEW.name AND p.file = NEW.file
    AND p.number = (SELECT max(number) FROM plan q WHERE q.site = p.site AND q.name = p.name) LIMIT 1;
  IF FOUND THEN
    RAISE EXCEPTION 'the plan % of the site has the file name % too', same, NEW.file
      USING HINT = 'rename the file: maps name their plan by it';
  END IF;
  NEW.number := coalesce(present.number, 0) + 1;
  RETURN NEW;
END $$;
CREATE TRIGGER number BEFORE INSERT ON byre.plan FOR EACH ROW EXECUTE FUNCTION byre.number_plan();

CREATE FUNCTION byre.log_plan() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = byre, pg_temp AS $$
BEGIN
  INSERT INTO event (site, actor, kind, subject, reason)
    VALUES (NEW.site, NEW.added_by, 'plan', NEW.name || ' ' || NEW.number, NEW.note);
  RETURN NULL;
END $$;
CREATE TRIGGER log AFTER INSERT ON byre.plan FOR EACH ROW EXECUTE FUNCTION byre.log_plan();

REVOKE EXECUTE ON FUNCTION byre.number_plan, byre.log_plan FROM PUBLIC;
GRANT SELECT ON byre.plan TO byre_robot, byre_reviewer, byre_worker;
-- A plan is current at once, without a review, so workers do not add any.
GRANT INSERT (site, name, file, blob, other_file, other_blob, note) ON byre.plan TO byre_reviewer;
ALTER TABLE byre.plan ENABLE ROW LEVEL SECURITY;
CREATE POLICY read_all ON byre.plan FOR SELECT TO byre_reviewer, byre_worker USING (true);
CREATE POLICY read_own ON byre.plan FOR SELECT TO byre_robot USING (
  site = (SELECT r.site FROM byre.robot r WHERE r.account = current_user));
CREATE POLICY add ON byre.plan FOR INSERT TO byre_reviewer WITH CHECK (true);
-- A robot reads the files of the plans that it reads.
CREATE POLICY read_planned ON byre.blob FOR SELECT TO byre_robot USING (
  EXISTS (SELECT FROM byre.plan p WHERE p.blob = hash) OR EXISTS (SELECT FROM byre.plan p WHERE p.other_blob = hash));
CREATE POLICY read_planned ON byre.blob_chunk FOR SELECT TO byre_robot USING (
  EXISTS (SELECT FROM byre.plan p WHERE p.blob = blob_chunk.blob)
  OR EXISTS (SELECT FROM byre.plan p WHERE p.other_blob = blob_chunk.blob));
