#pragma once

#include "byre/playback/play.h"

#include <iosfwd>
#include <optional>

namespace byre {

// Writes JSON lines: one object per session event, state change and verdict change
// (docs/reference/health_and_events.md). The stream must outlive it.
class EventLog {
 public:
  explicit EventLog(std::ostream& stream) : stream_(stream) {}

  // Call after each frame, in order; number: frame number from 0. Flushes the stream.
  void note(int number, const PlayedFrame& frame);

 private:
  std::ostream& stream_;
  // Values after the last readable frame.
  std::optional<State> state_;
  std::optional<Verdict> verdict_;
  std::optional<Pose> map_from_odometry_;  // last available value
};

}  // namespace byre
