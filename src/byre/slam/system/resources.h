#pragma once

namespace byre {

// Resources used by the process since its start.
struct ResourceUsage {
  double cpu_seconds = 0.0;  // user and system time of all threads
  double peak_memory_mb = 0.0;
};

ResourceUsage resource_usage();

// Returns freed memory from the allocator to the system. Takes milliseconds.
void release_free_memory();

double resident_memory_mb();  // current; zero if not available

// Raises the limit of open files to its maximum, but to a thousand at most, so that connections do not exhaust the
// program's own need.
void raise_descriptor_limit();

}  // namespace byre
