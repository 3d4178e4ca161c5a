#include "byre/node/service_manager.h"

#include <cstdint>

#include <systemd/sd-daemon.h>

namespace byre {

ServiceManager::ServiceManager() {
  std::uint64_t microseconds = 0;
  // Half of what the manager waits, as sd_watchdog_enabled(3) has it.
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
  sd_notify(0, ("STATUS=" + line).c_str());
}

void ServiceManager::alive() {
  const auto now = std::chrono::steady_clock::now();
  if (!interval_ || (last_alive_ && now - *last_alive_ < *interval_)) return;
  last_alive_ = now;
  sd_notify(0, "WATCHDOG=1");
}

}  // namespace byre
