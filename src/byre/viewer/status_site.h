#pragma once

#include "byre/viewer/web_site.h"

#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace byre {

// How a program is, as others ask it by HTTP.
struct ProgramStatus {
  bool is_well = false;
  std::string summary;  // a line
  std::string metrics;  // figures as Prometheus reads them
};

// Where a program puts how it is, from any thread.
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

// /healthz: 200 where the program is well, else 503; /metrics: its figures.
class StatusSite : public WebSite {
 public:
  explicit StatusSite(std::shared_ptr<const StatusBoard> board) : board_(std::move(board)) {}

  WebResponse answer(const WebRequest& request) override;

 private:
  std::shared_ptr<const StatusBoard> board_;  // constant after construction
};

}  // namespace byre
