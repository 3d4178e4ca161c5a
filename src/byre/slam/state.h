#pragma once

#include "byre/state.h"

#include <cstdint>

namespace byre {

// What one frame told us.
struct Evidence {
  bool pose_found = false;
  bool pose_confirmed = true;         // by enough frames, where it was found without a prediction
  double seconds_without_pose = 0.0;  // since the last confirmed one
};

struct StateOptions {
  double lost_after = 10.0;  // seconds without a confirmed pose: then the robot is told of a navigation error
};

State next_state(State state, const Evidence& evidence, const StateOptions& options);

// Relocalising or lost: there was a pose once, and now there is none to rely on.
inline bool has_lost_its_way(State state) {
  return state == State::relocalising || state == State::lost;
}

// What became of the offline points.
//   held         enough of them hold the pose
//   off_the_map  from the predicted pose hardly any should be in view: the robot has left the mapped area
//   blinded      they should be in view, but the image shows too little of anything
//   changed      they should be in view, and the image is good: things have moved, or look different
enum class OfflineView : std::uint8_t { held, off_the_map, blinded, changed };

struct OfflineEvidence {
  int expected = 0;  // offline points in the frustum of the pose, predicted where there is no other
  int inliers = 0;   // offline points that fit the pose
  bool image_is_faulty = false;
  int features = 0;  // features in the image
};

struct OfflineViewOptions {
  int min_inliers = 20;   // least offline inliers that hold a pose
  int min_expected = 40;  // offline points in the frustum; with fewer, off the map
  int min_features = 50;  // features in the image; with fewer, blinded
};

OfflineView view_of_offline(const OfflineEvidence& evidence, const OfflineViewOptions& options);

}  // namespace byre
