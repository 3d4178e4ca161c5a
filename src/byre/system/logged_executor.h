#pragma once

#include "byre/workers/executor.h"

#include <memory>
#include <vector>

namespace byre {

struct JobLog {
  std::vector<double> job_seconds;  // wall time of each job that finished since the last frame began, in order
  double submit_seconds = 0.0;      // calling thread's time: of whole jobs where they run inline, else next to none
};

// Does as the other executor, and notes what it did in a log that must outlive it.
std::unique_ptr<Executor> make_logged_executor(std::unique_ptr<Executor> executor, JobLog& log);

}  // namespace byre
