#pragma once

#include <any>
#include <functional>
#include <memory>
#include <optional>

namespace byre {

using Job = std::function<std::any()>;

// What a job came to.
struct FinishedJob {
  std::any result;
  double seconds = 0.0;  // wall time the job took
};

// Where and when mapping runs, whatever it results in; a Worker knows that. At most one job is in flight. All methods
// are called from one thread. An exception thrown by a job is thrown again by the collect() or finish() that would have
// handed its result over.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void submit(Job job) = 0;                  // precondition: idle()
  virtual std::optional<FinishedJob> collect() = 0;  // called once per frame
  virtual std::optional<FinishedJob> finish() = 0;   // waits for the job in flight, if there is one
  virtual bool idle() const = 0;                     // no job in flight and none to be collected
};

// Runs the job in submit(); the next collect() hands it over. No threads.
std::unique_ptr<Executor> make_inline_executor();

// One worker; collect() hands the result over exactly latency frames after submit(), waiting for it if it must.
// Parallel, yet every run of a recording gives the same result. Precondition: latency > 0.
std::unique_ptr<Executor> make_paced_executor(int latency);

// One worker; collect() hands the result over as soon as it is there. For live robots.
std::unique_ptr<Executor> make_live_executor();

}  // namespace byre
