#pragma once

#include "degradation.h"

#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

// One image pair that the robot is given.
struct MissionStep {
  int frame = 0;                                         // number of the frame in the recording
  Timestamp time{};                                      // time that the robot is told
  std::function<ImageFrame(const ImageFrame&)> disturb;  // what is done to the images; empty: nothing
};

// What happens to the robot, as a rearrangement of a recording.
struct MissionPlan {
  std::vector<MissionStep> steps;
  // From when on nothing disturbs any more; the first step's where nothing ever does, empty where it does to the end.
  std::optional<Timestamp> undisturbed_from;

  // Time of the first step whose images are disturbed; of the very first where none is.
  Timestamp disturbed_from() const;
};

// Seconds from the beginning of a recording, end exclusive.
struct Span {
  double start = 0.0;
  double end = 0.0;
};

// All frames, at their own times. Precondition, as below: times ascend and there are some.
MissionPlan as_recorded(const std::vector<Timestamp>& times);

// The same with the images of a span degraded. A span that reaches the end is never over.
MissionPlan degraded(const std::vector<Timestamp>& times, const Span& span, const Degradation& degradation);

// The robot is carried away after the first span and set down where the second begins; times go on as if nothing had
// happened. For so many seconds before it is set down the images are black.
MissionPlan kidnapped(const std::vector<Timestamp>& times, const Span& before, const Span& after, double dark_seconds);

// Each image is given so many times in a row, at the times of those it takes the place of.
MissionPlan repeated(const std::vector<Timestamp>& times, int times_each);

// One image of so many arrives.
MissionPlan dropped(const std::vector<Timestamp>& times, int kept_every);

// The clock is put forward when the span begins, and back again, as far as time may, when it ends.
MissionPlan late(const std::vector<Timestamp>& times, const Span& span, double jump_seconds);

}  // namespace byre
