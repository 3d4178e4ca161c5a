#pragma once

// Helper for tests of values with jobs.

#include "byre/base/job_slot.h"

#include <optional>

namespace byre {

// Runs the requested job on the calling thread and delivers its result.
inline void run_at_once(JobState& job) {
  if (const std::optional<Job> request = job.take_request()) job.deliver({(*request)(), 0.0});
}

}  // namespace byre
