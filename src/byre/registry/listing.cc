#include "byre/registry/listing.h"

#include "byre/input_error.h"

#include <array>

#include <fmt/format.h>

namespace byre {
namespace {

// Gauge of Prometheus. rows: a value, then names and values of labels by turns.
struct Gauge {
  const char* name;
  const char* help;
  const char* rows;
};

constexpr std::array kGauges = {
    Gauge{"byre_registry_versions", "Versions of maps", R"(
      SELECT count(v), 'site', s.name, 'state', t.state FROM byre.site s
        CROSS JOIN (VALUES ('proposed'), ('accepted'), ('retired')) t (state)
        LEFT JOIN byre.version v ON v.site = s.id AND v.state = t.state GROUP BY s.name, t.state ORDER BY s.name, t.state)"},
    Gauge{"byre_registry_open_sessions", "Sessions that no accepted or rejected version has yet", R"(
      SELECT count(o), 'site', s.name FROM byre.site s
        LEFT JOIN byre.session o ON o.site = s.id AND o.state = 'open' GROUP BY s.name ORDER BY s.name)"},
    Gauge{"byre_registry_jobs", "Jobs; failed: set aside", R"(
      SELECT count(j), 'site', s.name, 'state', t.state FROM byre.site s
        CROSS JOIN (VALUES ('waiting'), ('running'), ('done'), ('failed')) t (state)
        LEFT JOIN byre.job j ON j.site = s.id AND j.state = t.state GROUP BY s.name, t.state ORDER BY s.name, t.state)"},
    Gauge{"byre_registry_oldest_job_seconds", "Age of the oldest job that is neither done nor set aside", R"(
      SELECT extract(epoch FROM now() - min(added_at))::numeric(12, 0), 'site', s.name FROM byre.job j
        JOIN byre.site s ON s.id = j.site WHERE state IN ('waiting', 'running') GROUP BY s.name ORDER BY s.name)"},
    Gauge{"byre_registry_robot_seen_timestamp_seconds", "Time of the last contact of a robot; 0: none", R"(
      SELECT coalesce(extract(epoch FROM seen_at), 0)::numeric(12, 0), 'site', s.name, 'robot', account FROM byre.robot r
        JOIN byre.site s ON s.id = r.site ORDER BY s.name, account)"},
    Gauge{"byre_registry_robot_sessions_waiting", "Sessions that a robot has not sent yet", R"(
      SELECT waiting, 'site', s.name, 'robot', account FROM byre.robot r
        JOIN byre.site s ON s.id = r.site ORDER BY s.name, account)"},
    Gauge{"byre_registry_robot_runs_accepted", "1: a robot runs the accepted version of its site", R"(
      SELECT (v.id IS NOT NULL)::int, 'site', s.name, 'robot', account, 'version', runs, 'refused', refused
        FROM byre.robot r JOIN byre.site s ON s.id = r.site
        LEFT JOIN byre.version v ON v.site = r.site AND v.id = r.runs AND v.state = 'accepted' ORDER BY s.name, account)"},
};

std::string escaped(const std::string& text) {
  std::string label;
  for (const char character : text) {
    if (character == '\\' || character == '"') label += '\\';
    label += character == '\n' ? std::string("\\n") : std::string(1, character);
  }
  return label;
}

}  // namespace

std::string registry_metrics(Connection& connection) {
  std::string text;
  for (const Gauge& gauge : kGauges) {
    text += fmt::format("# HELP {0} {1}\n# TYPE {0} gauge\n", gauge.name, gauge.help);
    const Rows rows = connection.run(gauge.rows);
    for (int row = 0; row < rows.size(); ++row) {
      std::string labels;
      for (int column = 1; column < rows.columns(); column += 2) {
        labels += fmt::format("{}{}=\"{}\"", labels.empty() ? "" : ",", rows.text(row, column),
                              escaped(rows.text(row, column + 1)));
      }
      text += fmt::format("{}{{{}}} {}\n", gauge.name, labels, rows.text(row, 0));
    }
  }
  return text;
}

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
        'plans', (SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
          SELECT DISTINCT ON (name) name, number, file, note, added_by,
            to_char(added_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS added_at
          FROM byre.plan WHERE site = $1 ORDER BY name, number DESC) x),
        'sessions', (SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
          SELECT id, name, ran_on, added_by,
            to_char(added_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS added_at
          FROM byre.session s WHERE site = $1 AND state = 'open' ORDER BY s.added_at DESC, s.id) x),
        'jobs', (SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
          SELECT id, kind, recording, state, attempts, worker, message FROM byre.job
          WHERE site = $1 AND state <> 'done' ORDER BY id DESC) x),
        'robots', (SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
          SELECT account, runs, refused, reason, waiting,
            to_char(seen_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS seen_at
          FROM byre.robot WHERE site = $1 ORDER BY account) x)))",
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

std::string plans_json(Connection& connection, std::int64_t site, const std::optional<std::string>& name) {
  return connection
      .run(R"(SELECT coalesce(json_agg(row_to_json(x)), '[]') FROM (
        SELECT name, number, file, other_file, f.size + o.size AS bytes, note, added_by,
          to_char(added_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') AS added_at
        FROM byre.plan p JOIN byre.blob f ON f.hash = p.blob JOIN byre.blob o ON o.hash = p.other_blob
        WHERE site = $1 AND name = coalesce($2, name) ORDER BY name, number DESC) x)",
           {site, name})
      .text(0, 0);
}

std::string listing_key(Connection& connection) {
  return connection
      .run(R"(SELECT concat_ws(' ', (SELECT max(id) FROM byre.event),
        (SELECT max(id) FROM byre.job),
        (SELECT count(*) FROM byre.plan),
        (SELECT string_agg(concat_ws(',', id, state, attempts), ' ' ORDER BY id) FROM byre.job
          WHERE state IN ('waiting', 'running')),
        (SELECT string_agg(concat_ws(',', site, id), ' ') FROM byre.version WHERE state = 'accepted'),
        (SELECT string_agg(concat_ws(',', account, runs, refused, waiting, date_trunc('minute', seen_at)), ' '
          ORDER BY account) FROM byre.robot)))")
      .text(0, 0);
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
