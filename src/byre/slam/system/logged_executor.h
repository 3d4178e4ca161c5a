#pragma once

#include "byre/base/executor.h"

#include <memory>
#include <vector>

namespace byre {

struct JobLog {
  std::vector<double> job_seconds;  // wall time of each job finished since the current frame began, in order
  double submit_seconds = 0.0;      // time of the calling thread; includes jobs run inline
};

// Wraps an executor and logs its times. The log must outlive it.
std::unique_ptr<Executor> make_logged_executor(std::unique_ptr<Executor> executor, JobLog& log);

}  // namespace byre
