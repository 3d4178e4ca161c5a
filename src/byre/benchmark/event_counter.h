#pragma once

#include <cstdint>
#include <optional>

namespace byre {

// Counts events of this thread and of those that it starts from here on, as perf_event_open(2) does; outside the kernel
// alone. It counts from its construction on.
class EventCounter {
 public:
  enum class Event { instructions, page_faults };

  explicit EventCounter(Event event);
  ~EventCounter();
  EventCounter(const EventCounter&) = delete;
  EventCounter& operator=(const EventCounter&) = delete;

  // Since the construction; empty where the machine has no such counter, as many virtual ones, or does not let this
  // program have it (kernel.perf_event_paranoid above 2).
  std::optional<std::uint64_t> count() const;

 private:
  int descriptor_ = -1;  // owned; below zero: there is none
};

}  // namespace byre
