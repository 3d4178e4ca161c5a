#include "byre/slam/system/resources.h"

#include <fstream>

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

namespace byre {
namespace {

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

ResourceUsage resource_usage() {
  constexpr double kMegabytesPerKibibyte = 1024.0 / 1e6;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
          kMegabytesPerKibibyte * static_cast<double>(usage.ru_maxrss)};
}

void release_free_memory() {
  malloc_trim(0);
}

double resident_memory_mb() {
  long all_pages = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> all_pages >> resident_pages;
  return 1e-6 * static_cast<double>(resident_pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void raise_descriptor_limit() {
  constexpr rlim_t kMany = 1024;  // limit of select()
  rlimit descriptors{};
  if (getrlimit(RLIMIT_NOFILE, &descriptors) != 0 || descriptors.rlim_cur >= kMany) return;
  descriptors.rlim_cur = std::min(kMany, descriptors.rlim_max);
  setrlimit(RLIMIT_NOFILE, &descriptors);
}

}  // namespace byre
