#pragma once

#include <any>
#include <functional>
#include <memory>
#include <optional>

namespace byre {

using Job = std::function<std::any()>;

struct FinishedJob {
  std::any result;
  double seconds = 0.0;  // wall time the job took
};

// Decides when and on which thread jobs run; see Worker for typed results. At most one job is in flight. All methods
// are called from one thread. collect() or finish() rethrows an exception of the job.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void submit(Job job) = 0;                  // precondition: idle()
  virtual std::optional<FinishedJob> collect() = 0;  // called once per frame
  // Same, earlier: a paced executor waits for its job instead of its latency.
  virtual std::optional<FinishedJob> collect_early() { return collect(); }
  virtual std::optional<FinishedJob> finish() = 0;  // waits for the job in flight, if any
  virtual bool idle() const = 0;                    // no job in flight and no result to collect
};

// Runs the job in submit(); the next collect() returns its result. No threads.
std::unique_ptr<Executor> make_inline_executor();

// One worker thread. collect() returns the result exactly latency frames after submit() and waits for it if necessary.
// Runs in parallel, yet each run of a recording gives the same result. Precondition: latency > 0.
std::unique_ptr<Executor> make_paced_executor(int latency);

// One worker thread. collect() returns the result as soon as it is available. For live robots.
std::unique_ptr<Executor> make_live_executor();

}  // namespace byre
