#pragma once

#include "byre/base/executor.h"

#include <any>
#include <cassert>
#include <optional>
#include <utility>

namespace byre {

// State of one job of a value: idle, requested, in flight, or finished with a result to collect. Holds no thread: the
// owner of the value takes requests, runs them and delivers the results.
class JobState {
 public:
  bool is_idle() const { return !is_busy_; }

  // For the owner: the requested job, at most once; it is in flight afterwards.
  std::optional<Job> take_request() { return std::exchange(request_, std::nullopt); }
  void deliver(FinishedJob finished) {
    assert(is_busy_ && !request_ && !finished_);
    finished_ = std::move(finished);
  }
  // For the owner: the job failed and has no result.
  void abandon() { *this = JobState(); }

 protected:
  std::optional<Job> request_;
  std::optional<FinishedJob> finished_;
  bool is_busy_ = false;  // from the request until the result is collected
};

// A job with a typed result, one at a time.
template <typename Result>
class JobSlot : public JobState {
 public:
  struct Finished {
    Result result;
    double seconds = 0.0;  // wall time the job took
  };

  // job() returns a Result and owns, or shares, all data that it reads. Precondition: is_idle().
  template <typename TypedJob>
  void request(TypedJob job) {
    assert(is_idle());
    request_ = [job = std::move(job)] { return std::any(std::in_place_type<Result>, job()); };
    is_busy_ = true;
  }

  std::optional<Finished> collect() {
    if (!finished_) return std::nullopt;
    is_busy_ = false;
    FinishedJob finished = *std::exchange(finished_, std::nullopt);
    return Finished{std::any_cast<Result>(std::move(finished.result)), finished.seconds};
  }
};

}  // namespace byre
