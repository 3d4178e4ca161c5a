#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <string_view>

namespace byre {

// The clock that a device's time stamps are of.
//   monotonic  the kernel's, which begins when the machine does: what nearly all drivers use
//   utc        the time of day
//   own        another one, as that of a program that feeds a virtual device
enum class CameraClock : std::uint8_t { monotonic, utc, own };

std::string_view to_string(CameraClock clock);

Timestamp monotonic_now();

// The machine's clocks at one moment.
struct MachineTime {
  Timestamp monotonic{};
  Timestamp utc{};
};

// Both read as closely together as some attempts allow.
MachineTime machine_time();

// The clock whose time the stamp is within ten seconds of. Flags of drivers say less: some always claim monotonic.
CameraClock clock_of(Timestamp stamp, const MachineTime& now);

// What turns stamps of that clock into UTC, so that they fit to those of other sensors; nothing is known of an own one.
Timestamp utc_offset(CameraClock clock, const MachineTime& now);

}  // namespace byre
