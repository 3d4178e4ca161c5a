#pragma once

namespace byre {

// Lets threads of usual priority go first from here on wherever processors are short: the calling thread gets a third
// of their share (its niceness is raised by 5), and takes no processor from one of them when there is something to do
// again (SCHED_BATCH). For threads that no frame waits for; a thread cannot take it back. Threads that the caller
// starts later give way as well.
void give_way_to_frames();

}  // namespace byre
