#include "byre/registry/jobs.h"

#include "byre/base/binary_file.h"
#include "byre/base/printable.h"
#include "byre/input_error.h"
#include "byre/place/map_words.h"
#include "byre/registry/blobs.h"
#include "byre/registry/versions.h"
#include "byre/slam/system/merge_maps.h"
#include "byre/slam/system/stored_map.h"

#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Sessions of one update. The rest waits for the next.
constexpr int kMaxSessions = 32;
constexpr std::size_t kMaxNote = 1000;  // bytes; limit of the schema

struct OpenSession {
  std::string id;
  StoredSession session;
};

std::string seconds(int s) {
  return fmt::format("{} s", s);
}

// Open sessions of a site, the oldest first. Those that cannot be read are closed by the result.
std::vector<OpenSession> pull_sessions(Connection& connection, const RegistryJob& job, const fs::path& folder,
                                       const Vocabulary& vocabulary, JobResult& result) {
  std::vector<OpenSession> sessions;
  std::vector<std::pair<std::string, std::string>> listed;
  persist(connection, [&] {
    listed.clear();
    const Rows rows = connection.run(
        "SELECT id, name FROM byre.session WHERE site = $1 AND state = 'open' ORDER BY added_at, id LIMIT $2",
        {job.site, kMaxSessions});
    for (int row = 0; row < rows.size(); ++row) listed.emplace_back(rows.text(row, 0), rows.text(row, 1));
  });
  for (const auto& [id, name] : listed) {
    const fs::path path = folder / (id + ".session");
    pull_session(connection, job.site, id, path);
    try {
      sessions.push_back({id, load_session(path, vocabulary)});
      sessions.back().session.name = name;
    } catch (const InputError& error) {
      result.closed.push_back({id, error.reason()});
    }
  }
  return sessions;
}

JobResult update(Connection& connection, const RegistryJob& job, const fs::path& folder, const Vocabulary& vocabulary,
                 const StepHook& before_step) {
  JobResult result;
  persist(connection, [&] { result.base = accepted_version(connection, job.site).value_or(""); });
  if (result.base.empty()) {
    result.message = "the site has no accepted version";
    return result;
  }
  before_step("pulling the sessions");
  std::vector<OpenSession> open = pull_sessions(connection, job, folder, vocabulary, result);
  if (open.empty()) {
    result.message = "the site has no open sessions";
    return result;
  }
  const fs::path base = folder / "base.byre";
  pull_map(connection, job.site, result.base, base);
  std::vector<StoredSession> sessions;
  for (OpenSession& each : open) sessions.push_back(std::move(each.session));
  MapUpdate made = update_map(load_version(base, vocabulary), sessions, vocabulary, before_step);
  for (std::size_t i = 0; i < made.sessions.size(); ++i) {
    const std::string& fault = made.sessions[i].place.fault;
    if (!fault.empty()) {
      result.closed.push_back({open[i].id, "it " + fault});
    } else if (made.child) {
      result.sessions.push_back(open[i].id);
    } else {
      result.closed.push_back({open[i].id, made.refusal});
    }
  }
  if (!made.child) {
    result.message = made.refusal;
    return result;
  }
  result.message = history_of(*made.child).front().change;
  result.child = folder / "child.byre";
  save_child(std::move(made), vocabulary, *result.child);
  result.parents = parents_of(*result.child);
  return result;
}

JobResult merge(Connection& connection, const RegistryJob& job, const fs::path& folder, const Vocabulary& vocabulary,
                const StepHook& before_step) {
  std::vector<fs::path> paths;
  for (const std::string& id : job.maps) {
    paths.push_back(folder / (id + ".byre"));
    pull_map(connection, job.site, id, paths.back());
  }
  StoredMap first = load_for_mapping(paths.at(0), vocabulary);
  StoredMap second = load_map(paths.at(1));
  add_words(second, vocabulary);
  FinishHooks hooks;
  hooks.before_step = before_step;
  const MergedMaps merged = merge_maps(first, second, vocabulary, hooks);
  JobResult result;
  if (!merged.refusal.empty()) {
    result.message = merged.refusal;
    return result;
  }
  result.message = fmt::format("{} merged into {}: {} of {} keyframes agree", job.maps[1], job.maps[0],
                               merged.place.agreeing, merged.place.keyframes);
  result.child = folder / "child.byre";
  save_for_missions(std::move(first), vocabulary, "", *result.child);
  result.parents = job.maps;
  for (const std::string& id : parents_of(paths[0])) result.parents.push_back(id);
  return result;
}

JobResult summarise(Connection& connection, const RegistryJob& job, const fs::path& folder,
                    const Vocabulary& vocabulary, const StepHook& before_step) {
  const fs::path path = folder / "base.byre";
  pull_map(connection, job.site, job.maps.at(0), path);
  MapUpdate made = summarise_map(load_version(path, vocabulary), job.keyframes, vocabulary, before_step);
  if (!made.child) return {.message = made.refusal};
  JobResult result{.message = history_of(*made.child).front().change, .child = folder / "child.byre"};
  save_child(std::move(made), vocabulary, *result.child);
  result.parents = parents_of(*result.child);
  return result;
}

// Stores the child beside the end of its job. Earlier proposals of the same parent are retired.
void store_child(Connection& connection, const RegistryJob& job, const JobResult& result, const std::string& id,
                 std::span<const std::byte> blob) {
  if (!result.base.empty()) {
    connection.run(
        "UPDATE byre.version v SET state = 'retired', reason = 'superseded by ' || $3 WHERE site = $1 AND parents[1] = "
        "$2 AND state = 'proposed' AND id <> $3 AND EXISTS (SELECT FROM byre.version_session s WHERE s.site = $1 AND "
        "s.version = v.id)",
        {job.site, result.base, id});
  }
  add_version(connection, job.site, id, blob, result.parents, printable(result.message, kMaxNote));
  for (const std::string& session : result.sessions) {
    connection.run("INSERT INTO byre.version_session VALUES ($1, $2, $3) ON CONFLICT DO NOTHING",
                   {job.site, id, session});
  }
}

}  // namespace

std::optional<RegistryJob> take_job(Connection& connection, const std::string& worker, const QueueOptions& options) {
  const Rows rows = connection.run(
      "SELECT id, site, kind, attempts, recording, calibration, keyframes, maps[1], maps[2] FROM byre.take_job($1, $2, "
      "$3, $4)",
      {worker, seconds(options.lease_s), options.max_attempts, options.kinds});
  if (rows.size() == 0) return std::nullopt;
  RegistryJob job{.id = rows.number(0, 0),
                  .site = rows.number(0, 1),
                  .kind = rows.text(0, 2),
                  .recording = rows.text(0, 4),
                  .calibration = rows.text(0, 5),
                  .keyframes = static_cast<int>(rows.number(0, 6)),
                  .attempt = static_cast<int>(rows.number(0, 3))};
  for (const int column : {7, 8}) {
    if (!rows.is_null(0, column)) job.maps.push_back(rows.text(0, column));
  }
  return job;
}

bool renew_lease(Connection& connection, const RegistryJob& job, const QueueOptions& options) {
  return connection
             .run(
                 "UPDATE byre.job SET due = now() + $3::interval WHERE id = $1 AND attempts = $2 AND state = 'running'",
                 {job.id, job.attempt, seconds(options.lease_s)})
             .changed() == 1;
}

void fail_job(Connection& connection, const RegistryJob& job, const QueueOptions& options, const std::string& reason) {
  connection.run("SELECT byre.fail_job($1, $2, $3, $4)", {job.id, job.attempt, options.max_attempts, reason});
}

JobResult work_on(Connection& connection, const RegistryJob& job, const fs::path& folder, const Vocabulary& vocabulary,
                  const RecordingMapper& map_recording, const StepHook& before_step) {
  if (job.kind == "update") return update(connection, job, folder, vocabulary, before_step);
  if (job.kind == "merge") return merge(connection, job, folder, vocabulary, before_step);
  if (job.kind == "summarise") return summarise(connection, job, folder, vocabulary, before_step);
  const fs::path map = folder / "child.byre";
  return {.message = map_recording(job, map), .child = map};
}

JobEnd end_job(Connection& connection, const RegistryJob& job, const JobResult& result) {
  std::optional<std::string> id;
  std::vector<std::byte> blob;
  if (result.child) {
    id = to_text(map_id(*result.child));
    blob = push_blob(connection, MappedFile(*result.child).bytes());
  }
  JobEnd end = JobEnd::done;
  persist(connection, [&] {
    Transaction transaction(connection);
    const Rows ended = connection.run(
        "UPDATE byre.job SET state = 'done', ended_at = now(), result = $3, message = $4 WHERE id = $1 AND attempts = "
        "$2 AND state = 'running'",
        {job.id, job.attempt, id, result.message});
    if (ended.changed() == 0) {  // unless the commit of this attempt broke the connection
      const Rows rows = connection.run("SELECT FROM byre.job WHERE id = $1 AND attempts = $2 AND state = 'done'",
                                       {job.id, job.attempt});
      end = rows.size() == 1 ? JobEnd::done : JobEnd::lost;
      return;
    }
    if (!result.base.empty() && accepted_version(connection, job.site) != result.base) {
      end = JobEnd::outdated;
      return;
    }
    for (const auto& [session, fault] : result.closed) {
      connection.run("UPDATE byre.session SET state = 'closed', reason = $3 WHERE site = $1 AND id = $2",
                     {job.site, session, printable(fault, kMaxNote)});
    }
    if (id) store_child(connection, job, result, *id, blob);
    transaction.commit();
  });
  if (end == JobEnd::outdated) {
    fail_job(connection, job, {.max_attempts = job.attempt + 1}, "another version was accepted meanwhile");
  }
  return end;
}

}  // namespace byre
