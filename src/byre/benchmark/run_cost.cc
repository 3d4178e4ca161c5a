#include "byre/benchmark/run_cost.h"

#include <fstream>
#include <string>

#include <linux/perf_event.h>
#include <malloc.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace byre {

bool reset_peak_memory() {
  malloc_trim(0);
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;  // resets the peak, see proc(5)
  return file.good();
}

std::optional<double> peak_memory_mb() {
  constexpr double kMegabytesPerKibibyte = 1024.0 / 1e6;
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    double kibibytes = 0.0;
    if (word == "VmHWM:" && file >> kibibytes) return kMegabytesPerKibibyte * kibibytes;
  }
  return std::nullopt;
}

InstructionCounter::InstructionCounter() {
  perf_event_attr attributes{};
  attributes.size = sizeof attributes;
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.inherit = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  constexpr int kThisThread = 0, kAnyProcessor = -1, kNoGroup = -1;
  descriptor_ = static_cast<int>(
      syscall(SYS_perf_event_open, &attributes, kThisThread, kAnyProcessor, kNoGroup, PERF_FLAG_FD_CLOEXEC));
}

InstructionCounter::~InstructionCounter() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::optional<std::uint64_t> InstructionCounter::count() const {
  std::uint64_t instructions = 0;
  if (descriptor_ < 0 || read(descriptor_, &instructions, sizeof instructions) != sizeof instructions)
    return std::nullopt;
  return instructions;
}

}  // namespace byre
