#pragma once

#include "degradation.h"

#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

struct MissionStep {
  int frame = 0;                                         // frame number in the recording
  Timestamp time{};                                      // time stamp given to the robot
  std::function<ImageFrame(const ImageFrame&)> disturb;  // change of the images; empty: none
};

// A mission as a rearrangement of a recording.
struct MissionPlan {
  std::vector<MissionStep> steps;
  // Time from which on no step is disturbed: the first step's if none is, empty if disturbances last to the end.
  std::optional<Timestamp> undisturbed_from;

  // Time of the first disturbed step; the first step's if none is.
  Timestamp disturbed_from() const;
};

// Seconds from the start of a recording, end exclusive.
struct Span {
  double start = 0.0;
  double end = 0.0;
};

// All frames at their own times. Precondition of all plans: times ascend and are not empty.
MissionPlan as_recorded(const std::vector<Timestamp>& times);

// Degrades the images of a span. A span that reaches the end of the recording never ends.
MissionPlan degraded(const std::vector<Timestamp>& times, const Span& span, const Degradation& degradation);

// Kidnaps the robot: after the first span it is moved to where the second begins, while times continue without a gap.
// The last dark_seconds of the first span are black.
MissionPlan kidnapped(const std::vector<Timestamp>& times, const Span& before, const Span& after, double dark_seconds);

// Repeats each image times_each times, at the times of the images it replaces.
MissionPlan repeated(const std::vector<Timestamp>& times, int times_each);

// Keeps one image of every kept_every.
MissionPlan dropped(const std::vector<Timestamp>& times, int kept_every);

// Advances the clock at the start of the span, and sets it back at its end as far as times stay ascending.
MissionPlan late(const std::vector<Timestamp>& times, const Span& span, double jump_seconds);

}  // namespace byre
