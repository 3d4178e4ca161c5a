#pragma once

#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/node_log.h"

#include <chrono>
#include <optional>
#include <string>

namespace byre {

// Reports the program's state to a service manager (sd_notify(3)), if one started it.
class ServiceManager {
 public:
  ServiceManager();

  void ready();
  void stopping();
  void status(const std::string& text);
  // Sends the watchdog signal if due. Call it only while the program works.
  void alive();
  // Extends the watchdog timeout until alive() is called again, such as for reading a large file.
  void busy(std::chrono::seconds longest);

 private:
  static void set_watchdog(std::chrono::microseconds time);

  std::optional<std::chrono::microseconds> interval_;  // constant after construction; empty: no watchdog
  std::optional<std::chrono::steady_clock::time_point> last_alive_;
  bool is_busy_ = false;
  std::string last_status_;
};

// Locks the program's memory, and sets the real-time priority of the calling thread, but not of threads that it starts,
// according to the settings. Missing permissions are logged.
void apply_process_settings(const NodeConfig& config, const NodeLog& log);

}  // namespace byre
