#pragma once

#include "byre/pose_hint.h"
#include "byre/trajectory.h"

#include <optional>

namespace byre {

// Whether a pose lies where a hint says that the robot is.
bool is_near(const PoseHint& hint, const Pose& map_from_body);

// The last hint given, while it counts.
class StandingHint {
 public:
  void withdraw() { hint_.reset(); }
  void give(const PoseHint& hint);  // one that is not finite takes the last one back
  // Once for each frame, in order of time.
  void pass(Timestamp frame);
  const std::optional<PoseHint>& get() const { return hint_; }  // empty: none counts

 private:
  std::optional<PoseHint> hint_;
  std::optional<Timestamp> first_frame_;  // since it was given
};

}  // namespace byre
