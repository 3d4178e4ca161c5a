#include "byre/base/background_thread.h"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace byre {

// On Linux both settings are per thread; POSIX defines them per process.
void lower_thread_priority() {
  constexpr int kNiceness = 5;
  const auto self = static_cast<id_t>(gettid());
  setpriority(PRIO_PROCESS, self, getpriority(PRIO_PROCESS, self) + kNiceness);
  const sched_param none{};
  if (sched_getscheduler(0) == SCHED_OTHER) sched_setscheduler(0, SCHED_BATCH, &none);
}

}  // namespace byre
