#pragma once

#include "byre/pose_hint.h"
#include "byre/trajectory.h"

#include <optional>

namespace byre {

// Whether a pose is within the hint's radius and turn.
bool is_near(const PoseHint& hint, const Pose& map_from_body);

// The last hint given, until it expires.
class ActiveHint {
 public:
  void clear() { hint_.reset(); }
  void set_hint(const PoseHint& hint);  // a non-finite hint withdraws the last one
  // Once for each frame, in order of time.
  void expire(Timestamp frame);
  const std::optional<PoseHint>& get() const { return hint_; }  // empty: none, or expired

 private:
  std::optional<PoseHint> hint_;
  std::optional<Timestamp> first_frame_;  // first frame after set_hint()
};

}  // namespace byre
