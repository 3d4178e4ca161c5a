#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace byre {

struct RobotLinkOptions {
  std::string database;  // as of libpq, see Connection; the account is the robot's
  std::string site;
  std::filesystem::path map;                 // map in use, of the site
  std::filesystem::path folder;              // queue of sessions, and fetched versions
  double interval_s = 60.0;                  // between contacts; longer after failures, at most 10 minutes
  std::uintmax_t max_bytes = 2'000'000'000;  // space of the sessions that wait
};

// State for people. Versions by id; empty: none or unknown.
struct RobotLinkState {
  std::string present;   // version in use
  std::string accepted;  // version of the site at the last contact
  std::string fetched;   // version in the folder that may be used next
  std::string refused;   // last version that was not used
  std::string reason;    // reason of the refusal
  int waiting = 0;       // sessions to be sent
  std::uintmax_t waiting_bytes = 0;
  int left_out = 0;   // sessions that were not stored because max_bytes was reached
  std::string fault;  // fault of the last attempt; empty: none, or not tried yet
  std::optional<std::chrono::system_clock::time_point> contact{};
};

// Robot's connection to a registry, on a thread of its own. Sends the sessions of a folder, oldest first, and fetches
// the accepted version of the site's map to it. The map in use stays as it is; its owner replaces it. Without a network
// sessions wait. All functions but the constructor return at once. Call them from one thread.
class RobotLink {
 public:
  // Throws InputError in a build without a PostgreSQL client.
  explicit RobotLink(const RobotLinkOptions& options);
  ~RobotLink();  // stops a transfer; waits for an attempt to connect, at most 10 s
  RobotLink(const RobotLink&) = delete;
  RobotLink& operator=(const RobotLink&) = delete;

  void start();  // makes the folder, and starts the thread; no effect once it runs

  // Path for the newest session, which proves a fetched version. Written by the caller, then queued.
  std::filesystem::path last_session() const;
  // Queues the last session under a name. False if max_bytes is reached: it does not wait then. Throws InputError if
  // the folder cannot be written.
  bool queue_last_session(const std::string& name);

  // File of the fetched version; empty without one. It is removed once another version is accepted.
  std::optional<std::filesystem::path> fetched() const;
  void refuse(const std::filesystem::path& version, const std::string& reason);  // notes why it is not used
  void note_present();                                                           // the map was replaced

  RobotLinkState state() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace byre
