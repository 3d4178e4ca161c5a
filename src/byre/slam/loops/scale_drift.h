#pragma once

#include "byre/map/map.h"
#include "byre/slam/tracking/tracking.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

// Depths of one scene point in two parts of a map, both from one camera.
struct DepthPair {
  double newer = 0.0;
  double older = 0.0;
  double sigma = 0.0;  // standard deviation of the logarithm of their ratio
};

// Scale drift between two parts of a map.
struct ScaleDrift {
  double old_per_new = 1.0;  // length in the older part per length in the newer
  double sigma = 0.0;        // standard deviation of the logarithm of old_per_new
};

// Depth pairs of the features that see a point of the keyframe's own and a point of the older part.
std::vector<DepthPair> depth_pairs(const Map& map, const Keyframe& keyframe, const TrackedFrame& in_older_part);

// Mean ratio of depths after outlier rejection by the distance from the median, relative to the spread. One camera
// measures directions better than lengths: its position is estimated from rays (localise), and only this scale is left.
// Empty with fewer than min_pairs inliers.
std::optional<ScaleDrift> estimate_scale_drift(std::span<const DepthPair> pairs, int min_pairs);

}  // namespace byre
