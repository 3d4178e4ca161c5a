#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>

namespace byre {

// How much a line matters, by the numbers of syslog(3).
enum class LogLevel : std::uint8_t { error = 3, warning = 4, notice = 5, info = 6 };

// Told what happens, a line each.
using NodeLog = std::function<void(LogLevel level, const std::string& line)>;

// Writes lines for a terminal, or for the journal of systemd with their level in front (sd-daemon(3)). Text from
// outside cannot begin another line. Lines beyond kAtOnce, and then beyond kPerSecond, are left out and counted,
// because a verdict may change with every frame.
class NodeLogger {
 public:
  static constexpr double kAtOnce = 30.0;
  static constexpr double kPerSecond = 2.0;

  // stream outlives this.
  NodeLogger(std::ostream& stream, bool is_for_journal) : stream_(stream), is_for_journal_(is_for_journal) {}

  // now: of a steady clock. Errors are never left out.
  void tell(LogLevel level, const std::string& line, Timestamp now);

 private:
  void write(LogLevel level, const std::string& content);

  std::ostream& stream_;  // outlives this
  bool is_for_journal_;   // constant after construction
  Timestamp last_{};
  double allowed_ = kAtOnce;  // lines
  int left_out_ = 0;
};

// Whether the standard error stream goes to the journal, as systemd tells in JOURNAL_STREAM.
bool is_journal_read();

}  // namespace byre
