#include "byre/registry/listing.h"

#include "byre/input_error.h"

namespace byre {

std::string sites_json(Connection& connection) {
  return connection
      .run(R"(SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
        SELECT name AS site,
          (SELECT v.id FROM byre.version v WHERE v.site = s.id AND v.state = 'accepted') AS accepted,
          (SELECT count(*) FROM byre.version v WHERE v.site = s.id AND v.state = 'proposed') AS proposed,
          (SELECT count(*) FROM byre.session o WHERE o.site = s.id AND o.state = 'open') AS open_sessions,
          (SELECT count(*) FROM byre.job j WHERE j.site = s.id AND j.state IN ('waiting', 'running')) AS jobs,
          (SELECT count(*) FROM byre.job j WHERE j.site = s.id AND j.state = 'failed') AS failed_jobs
        FROM byre.site s ORDER BY name) x)")
      .text(0, 0);
}

std::string site_json(Connection& connection, std::int64_t site) {
  return connection
      .run(R"(SELECT json_build_object(
        'site', (SELECT name FROM byre.site WHERE id = $1),
        'versions', (SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
          SELECT v.id, state, b.size AS bytes, parents[1] AS parent, note, added_by,
            to_char(added_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS added_at, reviewed_by, reason
          FROM byre.version v JOIN byre.blob b ON b.hash = v.blob WHERE site = $1 ORDER BY v.added_at DESC, v.id) x),
        'sessions', (SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
          SELECT id, name, ran_on, added_by,
            to_char(added_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS added_at
          FROM byre.session s WHERE site = $1 AND state = 'open' ORDER BY s.added_at DESC, s.id) x),
        'jobs', (SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
          SELECT id, kind, state, attempts, worker, message FROM byre.job
          WHERE site = $1 AND state <> 'done' ORDER BY id DESC) x)))",
           {site})
      .text(0, 0);
}

std::string version_json(Connection& connection, std::int64_t site, const std::string& id) {
  const Rows rows = connection.run(R"(SELECT row_to_json(x) FROM (
      SELECT v.id, state, b.size AS bytes, parents, note, added_by,
        to_char(added_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS added_at, reviewed_by, reason,
        (SELECT coalesce(json_agg(row_to_json(y)), '[]') FROM (
          SELECT s.id, s.name, s.ran_on, s.added_by FROM byre.version_session u
            JOIN byre.session s ON s.site = u.site AND s.id = u.session
          WHERE u.site = $1 AND u.version = $2 ORDER BY s.added_at, s.id) y) AS sessions,
        (SELECT coalesce(json_agg(row_to_json(y)), '[]') FROM (
          SELECT to_char(at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS at, actor, kind, reason
          FROM byre.event e WHERE site = $1 AND subject = $2 ORDER BY e.id) y) AS events
      FROM byre.version v JOIN byre.blob b ON b.hash = v.blob WHERE site = $1 AND v.id = $2) x)",
                                   {site, id});
  if (rows.size() == 1) return rows.text(0, 0);
  throw InputError(connection.place(), "has no version " + id + " of this site, or the account may not read it",
                   "list the site with byre registry list");
}

std::string events_json(Connection& connection, std::int64_t site) {
  return connection
      .run(R"(SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
        SELECT to_char(at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS at, actor, kind, subject, reason
        FROM byre.event e WHERE site = $1 ORDER BY e.id DESC) x)",
           {site})
      .text(0, 0);
}

}  // namespace byre
