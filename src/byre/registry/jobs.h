#pragma once

#include "byre/place/vocabulary.h"
#include "byre/registry/connection.h"
#include "byre/slam/upkeep/update_map.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Kinds of jobs.
inline constexpr std::array kRegistryJobKinds = {"update", "merge", "map", "summarise"};

struct QueueOptions {
  std::vector<std::string> kinds{kRegistryJobKinds.begin(), kRegistryJobKinds.end()};  // kinds to take
  int lease_s = 60;      // a job whose worker does not renew its lease is taken again
  int max_attempts = 5;  // attempts after which it is set aside
};

// Job of a worker, leased. An attempt that lost its lease can neither renew nor end the job.
struct RegistryJob {
  std::int64_t id = 0;
  std::int64_t site = 0;
  std::string kind{};               // one of kRegistryJobKinds
  std::vector<std::string> maps{};  // two versions to merge, or one to summarise
  std::string recording{};          // path, of a recording to map
  std::string calibration{};        // path of another calibration than that of the recording; empty: none
  int keyframes = 0;                // keyframes of a place, to summarise
  int attempt = 0;
};

// Takes the job that is due first, if any. worker: name, for people.
std::optional<RegistryJob> take_job(Connection& connection, const std::string& worker, const QueueOptions& options);
// False if the lease was lost.
bool renew_lease(Connection& connection, const RegistryJob& job, const QueueOptions& options);
// Lets the job wait for its next attempt, or sets it aside after the last.
void fail_job(Connection& connection, const RegistryJob& job, const QueueOptions& options, const std::string& reason);

struct SessionFault {
  std::string session;  // id
  std::string fault;
};

// Work of a job, not yet in the registry.
struct JobResult {
  std::string message{};                         // for people
  std::optional<std::filesystem::path> child{};  // map file, in the folder of the job
  std::vector<std::string> parents{};
  std::string base{};                   // updated version, which must still be accepted; empty for other kinds
  std::vector<std::string> sessions{};  // sessions in the child
  std::vector<SessionFault> closed{};   // sessions without use
};

// Writes the map of the recording of a job, as "byre map". Returns a description of it.
using RecordingMapper = std::function<std::string(const RegistryJob& job, const std::filesystem::path& map)>;

// Does the work of a job on maps and sessions that it pulls to a folder, by the functions of "byre update" and "byre
// merge". Throws ConnectionLost, and InputError for maps that it cannot use.
JobResult work_on(Connection& connection, const RegistryJob& job, const std::filesystem::path& folder,
                  const Vocabulary& vocabulary, const RecordingMapper& map_recording, const StepHook& before_step);

enum class JobEnd {
  done,
  lost,     // the lease was lost: another worker has the job
  outdated  // another version was accepted meanwhile: the job waits for its next attempt
};

// Stores the result and ends the job in one transaction: a job ends with at most one result. Idempotent.
JobEnd end_job(Connection& connection, const RegistryJob& job, const JobResult& result);

}  // namespace byre
