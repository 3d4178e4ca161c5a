#pragma once

#include "byre/base/executor.h"

#include <any>
#include <memory>
#include <optional>
#include <utility>

namespace byre {

// Runs jobs with a typed result on an executor, one at a time. Called from one thread.
template <typename Result>
class Worker {
 public:
  struct Finished {
    Result result;
    double seconds = 0.0;  // wall time the job took
  };

  explicit Worker(std::unique_ptr<Executor> executor) : executor_(std::move(executor)) {}

  bool idle() const { return executor_->idle(); }

  // job() returns a Result and owns, or shares, all data that it reads. Precondition: idle().
  template <typename TypedJob>
  void start(TypedJob job) {
    executor_->submit([job = std::move(job)] { return std::any(std::in_place_type<Result>, job()); });
  }

  std::optional<Finished> collect() { return typed(executor_->collect()); }  // once per frame
  std::optional<Finished> finish() { return typed(executor_->finish()); }    // waits for the job in flight

 private:
  static std::optional<Finished> typed(std::optional<FinishedJob> finished) {
    if (!finished) return std::nullopt;
    return Finished{std::any_cast<Result>(std::move(finished->result)), finished->seconds};
  }

  std::unique_ptr<Executor> executor_;  // constant after construction
};

}  // namespace byre
