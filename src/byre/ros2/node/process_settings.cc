#include "byre/ros2/node/process_settings.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <sched.h>
#include <sys/mman.h>

namespace byre {
namespace {

std::string reason() {
  return std::generic_category().message(errno);
}

}  // namespace

void apply_process_settings(const NodeConfig& config, const NodeLog& log) {
  // MCL_ONFAULT locks pages on first use, as most of a map is never used.
  if (config.locks_memory && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0) {
    log(LogLevel::warning, "process.lock_memory: not allowed (" + reason() + "): raise LimitMEMLOCK of the service");
  }
  if (config.priority == 0) return;
  sched_param wanted{};
  wanted.sched_priority = config.priority;
  if (sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &wanted) != 0) {
    log(LogLevel::warning, "process.priority: not allowed (" + reason() + "): raise LimitRTPRIO of the service");
  }
}

}  // namespace byre
