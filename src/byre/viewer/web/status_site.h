#pragma once

#include "byre/viewer/web/web_site.h"

#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace byre {

// Status of a program for HTTP clients.
struct ProgramStatus {
  bool is_healthy = false;
  std::string summary;  // one line
  std::string metrics;  // Prometheus text format
};

// Current status of a program; thread-safe.
class StatusBoard {
 public:
  void put(ProgramStatus status) {
    const std::lock_guard lock(mutex_);
    status_ = std::move(status);
  }
  ProgramStatus get() const {
    const std::lock_guard lock(mutex_);
    return status_;
  }

 private:
  mutable std::mutex mutex_;
  ProgramStatus status_;  // guarded by mutex_
};

// Serves /healthz (200 if the program is well, else 503), /metrics, and a front page with both.
class StatusSite : public WebSite {
 public:
  explicit StatusSite(std::shared_ptr<const StatusBoard> board) : board_(std::move(board)) {}

  WebResponse answer(const WebRequest& request) override;

 private:
  std::shared_ptr<const StatusBoard> board_;  // constant after construction
};

}  // namespace byre
