#pragma once

#include <optional>

namespace byre {

// Hands memory that is free back to the system and begins a new peak, so that the next one is of what comes and not of
// what came before. False where the system does not let programs do so.
bool reset_peak_memory();

// Most resident memory since the last reset, or since the program began; of the whole program. Empty where the system
// does not tell.
std::optional<double> peak_memory_mb();

}  // namespace byre
