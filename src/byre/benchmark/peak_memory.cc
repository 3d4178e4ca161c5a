#include "byre/benchmark/peak_memory.h"

#include <fstream>
#include <string>

#include <malloc.h>

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

}  // namespace byre
