#include "byre/camera/camera_clock.h"

#include <chrono>

namespace byre {
namespace {

bool is_near(Timestamp a, Timestamp b) {
  constexpr Timestamp kNear = std::chrono::seconds(10);
  return std::chrono::abs(a - b) <= kNear;
}

}  // namespace

Timestamp monotonic_now() {
  return std::chrono::steady_clock::now().time_since_epoch();  // CLOCK_MONOTONIC, same as drivers
}

std::string_view to_string(CameraClock clock) {
  switch (clock) {
    case CameraClock::monotonic:
      return "monotonic";
    case CameraClock::utc:
      return "utc";
    case CameraClock::own:
      return "own";
  }
  return "";
}

MachineTime machine_time() {
  constexpr int kAttempts = 5;
  MachineTime best;
  Timestamp least = Timestamp::max();
  for (int i = 0; i < kAttempts; ++i) {
    const Timestamp before = monotonic_now();
    const Timestamp utc = std::chrono::system_clock::now().time_since_epoch();
    const Timestamp took = monotonic_now() - before;
    if (took >= least) continue;
    least = took;
    best = {before + took / 2, utc};
  }
  return best;
}

CameraClock clock_of(Timestamp stamp, const MachineTime& now) {
  if (is_near(stamp, now.monotonic)) return CameraClock::monotonic;
  return is_near(stamp, now.utc) ? CameraClock::utc : CameraClock::own;
}

Timestamp utc_offset(CameraClock clock, const MachineTime& now) {
  return clock == CameraClock::monotonic ? now.utc - now.monotonic : Timestamp{};
}

}  // namespace byre
