#pragma once

#include "byre/playback/map_run.h"

#include <iosfwd>
#include <optional>

namespace byre {

// Tells what happens as it happens: JSON lines, one object for each event of the session and for each change of its
// state and of its verdict, as docs/mission.md describes them. The stream must outlive it.
class EventLog {
 public:
  explicit EventLog(std::ostream& stream) : stream_(stream) {}

  // After each frame, in order; number: the frame's, from 0. What it writes is flushed.
  void note(int number, const MappedFrame& frame);

 private:
  std::ostream& stream_;
  // As the last frame that was read left them.
  std::optional<State> state_;
  std::optional<Verdict> verdict_;
  std::optional<Pose> map_from_odometry_;  // as last known
};

}  // namespace byre
