#pragma once

namespace byre {

// What the whole program has used since its start.
struct ResourceUse {
  double cpu_seconds = 0.0;  // user and system, of all threads
  double peak_memory_mb = 0.0;
};

ResourceUse resources_used_so_far();

// Hands memory that was freed back to the system, which the allocator would rather keep. Takes milliseconds.
void release_free_memory();

double resident_memory_mb();  // now; zero where the system does not tell

// Lets this program have as many files open at once as it may ask for, but no more than a thousand: so many connections
// that what it has to read and write is never short of them.
void allow_many_descriptors();

}  // namespace byre
