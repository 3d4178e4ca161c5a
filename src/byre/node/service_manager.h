#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace byre {

// Tells the service manager that started the program how it is (sd_notify(3)); nothing where none did.
class ServiceManager {
 public:
  ServiceManager();

  void ready();
  void stopping();
  void status(const std::string& text);
  // Whether the manager wants to hear again that the program is alive, and that it is. Call it only when it is.
  void alive();
  // That it will be silent for so long at most, for instance while a large file is read, until it is alive again.
  void busy(std::chrono::seconds longest);

 private:
  static void set_watchdog(std::chrono::microseconds time);

  std::optional<std::chrono::microseconds> interval_;  // constant after construction; empty: nobody wants to hear
  std::optional<std::chrono::steady_clock::time_point> last_alive_;
  bool is_busy_ = false;
  std::string last_status_;
};

}  // namespace byre
