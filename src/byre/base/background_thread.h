#pragma once

namespace byre {

// Lowers the priority of the calling thread for good, so that frame threads run first when processors are short. Raises
// niceness by 5 (a third of the share of a usual thread) and selects SCHED_BATCH (no preemption of other threads on
// wake-up). Threads started later by the caller inherit both. Only for threads that no frame waits for.
void lower_thread_priority();

}  // namespace byre
