#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <string_view>

namespace byre {

// Clock of a device's time stamps.
//   monotonic  the kernel's, which begins at boot: used by nearly all drivers
//   utc        time of day
//   own        another one, such as that of a program that feeds a virtual device
enum class CameraClock : std::uint8_t { monotonic, utc, own };

std::string_view to_string(CameraClock clock);

Timestamp monotonic_now();

// Simultaneous readings of the machine's clocks.
struct MachineTime {
  Timestamp monotonic{};
  Timestamp utc{};
};

// Best of several attempts to read both clocks together.
MachineTime machine_time();

// The clock whose reading is within ten seconds of the stamp. Flags of drivers are unreliable: some always claim
// monotonic.
CameraClock clock_of(Timestamp stamp, const MachineTime& now);

// Offset from stamps of that clock to UTC, for comparison with other sensors; zero for a clock of its own.
Timestamp utc_offset(CameraClock clock, const MachineTime& now);

}  // namespace byre
