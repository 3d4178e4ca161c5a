-- Schema 3 of a registry of maps: what robots run, as they report it.
ALTER TABLE byre.robot
  ADD seen_at timestamptz,  -- last contact; null: none yet
  ADD runs text NOT NULL DEFAULT '' CHECK (runs ~ '^([0-9a-f]{16})?$'),        -- version in use
  ADD refused text NOT NULL DEFAULT '' CHECK (refused ~ '^([0-9a-f]{16})?$'),  -- version that it does not use
  ADD reason text NOT NULL DEFAULT '' CHECK (length(reason) <= 1000),          -- reason of the refusal
  ADD waiting int NOT NULL DEFAULT 0;  -- sessions that it has not sent yet
GRANT UPDATE (seen_at, runs, refused, reason, waiting) ON byre.robot TO byre_robot;
CREATE POLICY report_own ON byre.robot FOR UPDATE TO byre_robot USING (account = current_user);
