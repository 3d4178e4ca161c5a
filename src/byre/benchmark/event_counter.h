#pragma once

#include <cstdint>
#include <optional>

namespace byre {

// Counts events by perf_event_open(2) in this thread and in threads it starts later; user space only. Starts counting
// on construction.
class EventCounter {
 public:
  enum class Event { instructions, page_faults };

  explicit EventCounter(Event event);
  ~EventCounter();
  EventCounter(const EventCounter&) = delete;
  EventCounter& operator=(const EventCounter&) = delete;

  // Since construction. Empty if the machine has no such counter, as many virtual ones, or denies access
  // (kernel.perf_event_paranoid above 2).
  std::optional<std::uint64_t> count() const;

 private:
  int descriptor_ = -1;  // owned; negative: unavailable
};

}  // namespace byre
