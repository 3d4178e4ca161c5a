#pragma once

namespace byre {

// What the whole program has used since its start.
struct ResourceUse {
  double cpu_seconds = 0.0;  // user and system, of all threads
  double peak_memory_mb = 0.0;
};

ResourceUse resources_used_so_far();

double resident_memory_mb();  // now; zero where the system does not tell

}  // namespace byre
