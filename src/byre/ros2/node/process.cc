#include "byre/ros2/node/process.h"

#include "byre/base/printable.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

#include <sched.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

namespace byre {
namespace {

std::string reason() {
  return std::generic_category().message(errno);
}

}  // namespace

void NodeLogger::write(LogLevel level, const std::string& content) {
  const std::string line = printable(content);
  if (is_for_journal_) {
    stream_ << '<' << static_cast<int>(level) << '>' << line << std::endl;
  } else {
    stream_ << "byre node: " << line << std::endl;
  }
}

void NodeLogger::log(LogLevel level, const std::string& line, Timestamp now) {
  tokens_ = std::min(kBurst, tokens_ + kPerSecond * to_seconds(now - std::exchange(last_, now)));
  if (tokens_ < 1.0 && level != LogLevel::error) {
    ++dropped_;
    return;
  }
  if (dropped_ > 0) write(LogLevel::notice, std::to_string(std::exchange(dropped_, 0)) + " log lines suppressed");
  tokens_ = std::max(0.0, tokens_ - 1.0);
  write(level, line);
}

bool is_connected_to_journal() {
  const char* const journal_stream = std::getenv("JOURNAL_STREAM");
  struct stat stream {};
  if (journal_stream == nullptr || fstat(STDERR_FILENO, &stream) != 0) return false;
  return std::to_string(stream.st_dev) + ":" + std::to_string(stream.st_ino) == std::string_view(journal_stream);
}

ServiceManager::ServiceManager() {
  std::uint64_t microseconds = 0;
  // Half of the timeout, as recommended by sd_watchdog_enabled(3).
  if (sd_watchdog_enabled(0, &microseconds) > 0) interval_ = std::chrono::microseconds(microseconds / 2);
}

void ServiceManager::ready() {
  sd_notify(0, "READY=1");
}

void ServiceManager::stopping() {
  sd_notify(0, "STOPPING=1");
}

void ServiceManager::status(const std::string& text) {
  if (text == last_status_) return;
  last_status_ = text;
  std::string line = text;
  for (char& letter : line) letter = letter == '\n' ? ' ' : letter;
  sd_notify(0, ("STATUS=" + printable(line)).c_str());
}

void ServiceManager::alive() {
  const auto now = std::chrono::steady_clock::now();
  if (!interval_ || (!is_busy_ && last_alive_ && now - *last_alive_ < *interval_)) return;
  last_alive_ = now;
  if (std::exchange(is_busy_, false)) set_watchdog(2 * *interval_);
  sd_notify(0, "WATCHDOG=1");
}

void ServiceManager::busy(std::chrono::seconds longest) {
  if (!interval_ || longest <= 2 * *interval_) return;
  is_busy_ = true;
  set_watchdog(longest);  // starting now
}

void ServiceManager::set_watchdog(std::chrono::microseconds time) {
  sd_notify(0, ("WATCHDOG_USEC=" + std::to_string(time.count())).c_str());
}

void apply_process_settings(const NodeConfig& config, const NodeLog& log) {
  // MCL_ONFAULT locks pages on first use, as most of a map is never used.
  if (config.locks_memory && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0) {
    log(LogLevel::warning, "process.lock_memory: not allowed (" + reason() + "): raise LimitMEMLOCK of the service");
  }
  if (config.priority == 0) return;
  sched_param wanted{};
  wanted.sched_priority = config.priority;
  if (sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &wanted) != 0) {
    log(LogLevel::warning, "process.priority: not allowed (" + reason() + "): raise LimitRTPRIO of the service");
  }
}

}  // namespace byre
