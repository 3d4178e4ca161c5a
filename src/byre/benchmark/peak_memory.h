#pragma once

#include <optional>

namespace byre {

// Returns free memory to the system and resets the peak. False if the system denies it.
bool reset_peak_memory();

// Peak resident memory of the program since the last reset, or since its start. Empty if the system does not report it.
std::optional<double> peak_memory_mb();

}  // namespace byre
