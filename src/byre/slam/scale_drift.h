#pragma once

#include "byre/map/map.h"
#include "byre/slam/tracking.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

// The depth of one thing as two parts of a map have it, both seen from one camera.
struct DepthPair {
  double newer = 0.0;
  double older = 0.0;
  double sigma = 0.0;  // standard deviation of the logarithm of their ratio
};

// By how much the scale of a map has drifted.
struct ScaleDrift {
  double old_per_new = 1.0;  // lengths of the older part for each of the newer
  double sigma = 0.0;        // standard deviation of the logarithm of old_per_new
};

// The features by which a keyframe sees points of its own and, where it was found in the older part, points of that.
std::vector<DepthPair> depth_pairs(const Map& map, const Keyframe& keyframe, const TrackedFrame& in_older_part);

// The mean ratio of depths without outliers: those far from the median, by the spread there is. One camera knows
// directions better than lengths, so where a camera lies is left to its rays (localise), and what is open is this.
// Empty with fewer than min_pairs that agree.
std::optional<ScaleDrift> estimate_scale_drift(std::span<const DepthPair> pairs, int min_pairs);

}  // namespace byre
