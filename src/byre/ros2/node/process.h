#pragma once

#include "byre/ros2/node/node_config.h"
#include "byre/trajectory.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>

namespace byre {

// Severities as numbered by syslog(3).
enum class LogLevel : std::uint8_t { error = 3, warning = 4, notice = 5, info = 6 };

struct LogLine {
  LogLevel level = LogLevel::info;
  std::string text;

  bool operator==(const LogLine&) const = default;
};

// Receiver of log lines.
using NodeLog = std::function<void(LogLevel level, const std::string& line)>;

// Writes lines for a terminal, or for systemd's journal with their level in front (sd-daemon(3)). Line breaks in text
// are escaped. At most kBurst lines in a burst and kPerSecond on average; the rest is counted and dropped, as verdicts
// may change at every frame.
class NodeLogger {
 public:
  static constexpr double kBurst = 30.0;
  static constexpr double kPerSecond = 2.0;

  // stream outlives this.
  NodeLogger(std::ostream& stream, bool is_for_journal) : stream_(stream), is_for_journal_(is_for_journal) {}

  // now: of a steady clock. Errors are never dropped.
  void log(LogLevel level, const std::string& line, Timestamp now);

 private:
  void write(LogLevel level, const std::string& content);

  std::ostream& stream_;  // outlives this
  bool is_for_journal_;   // constant after construction
  Timestamp last_{};
  double tokens_ = kBurst;  // lines that may be written now
  int dropped_ = 0;
};

// Whether standard error is connected to the journal, by JOURNAL_STREAM of systemd.
bool is_connected_to_journal();

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
