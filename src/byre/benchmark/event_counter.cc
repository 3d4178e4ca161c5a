#include "byre/benchmark/event_counter.h"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace byre {

EventCounter::EventCounter(Event event) {
  perf_event_attr attributes{};
  attributes.size = sizeof attributes;
  const bool is_of_processor = event == Event::instructions;
  attributes.type = is_of_processor ? PERF_TYPE_HARDWARE : PERF_TYPE_SOFTWARE;
  attributes.config =
      is_of_processor ? std::uint64_t{PERF_COUNT_HW_INSTRUCTIONS} : std::uint64_t{PERF_COUNT_SW_PAGE_FAULTS};
  attributes.inherit = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  constexpr int kThisThread = 0, kAnyProcessor = -1, kNoGroup = -1;
  descriptor_ = static_cast<int>(
      syscall(SYS_perf_event_open, &attributes, kThisThread, kAnyProcessor, kNoGroup, PERF_FLAG_FD_CLOEXEC));
}

EventCounter::~EventCounter() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::optional<std::uint64_t> EventCounter::count() const {
  std::uint64_t events = 0;
  if (descriptor_ < 0 || read(descriptor_, &events, sizeof events) != sizeof events) return std::nullopt;
  return events;
}

}  // namespace byre
