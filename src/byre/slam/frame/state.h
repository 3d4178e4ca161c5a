#pragma once

#include "byre/state.h"

#include <cstdint>

namespace byre {

// Evidence of one frame.
struct Evidence {
  bool pose_found = false;
  bool pose_confirmed = true;         // tracked for enough frames, after a find without a prediction
  double seconds_without_pose = 0.0;  // since the last confirmed pose
};

struct StateOptions {
  double lost_after = 10.0;  // seconds without a confirmed pose before a navigation error
};

State next_state(State state, const Evidence& evidence, const StateOptions& options);

// Relocalising or lost: there was a pose, and there is no reliable one now.
inline bool needs_relocalisation(State state) {
  return state == State::relocalising || state == State::lost;
}

// State of the offline points.
//   held         enough of them constrain the pose
//   off_the_map  hardly any are expected in view: the robot has left the mapped area
//   blinded      many are expected in view, but the image has too few features
//   changed      many are expected in view, and the image is good: the scene has changed, or looks different
enum class OfflineView : std::uint8_t { held, off_the_map, blinded, changed };

struct OfflineEvidence {
  int expected = 0;  // offline points in the frustum of the pose, or of the predicted one
  int inliers = 0;   // offline points that fit the pose
  bool image_is_faulty = false;
  int features = 0;  // features in the image
};

struct OfflineViewOptions {
  int min_inliers = 12;   // offline inliers that constrain a pose
  int min_expected = 40;  // offline points in the frustum; with fewer, off the map
  int min_features = 50;  // features in the image; with fewer, blinded
};

OfflineView view_of_offline(const OfflineEvidence& evidence, const OfflineViewOptions& options);

}  // namespace byre
