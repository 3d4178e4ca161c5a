#pragma once

#include <cstdint>
#include <optional>

namespace byre {

// Returns free memory to the system and resets the peak. False if the system denies it.
bool reset_peak_memory();

// Peak resident memory of the program since the last reset, or since its start. Empty if the system does not report it.
std::optional<double> peak_memory_mb();

// Counts instructions by perf_event_open(2) in this thread and in threads it starts later; user space only. Starts
// counting on construction.
class InstructionCounter {
 public:
  InstructionCounter();
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  // Since construction. Empty if the machine has no such counter, as many virtual ones, or denies access
  // (kernel.perf_event_paranoid above 2).
  std::optional<std::uint64_t> count() const;

 private:
  int descriptor_ = -1;  // owned; negative: unavailable
};

}  // namespace byre
