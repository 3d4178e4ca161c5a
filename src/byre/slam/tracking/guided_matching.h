#pragma once

#include "byre/base/scratch_memory.h"
#include "byre/map/map_view.h"

#include <limits>
#include <optional>
#include <span>

namespace byre {

// Predicted image of a map point.
struct Projection {
  StereoPixel predicted;  // u, v, disparity; pixels
  int octave = 0;         // octave of its corner
};

// Empty outside the frustum, and at distances and angles for which the descriptor is not valid.
std::optional<Projection> project_point(const MapPoint& point, const Pose& camera_from_world,
                                        const Eigen::Vector3d& camera_in_world, const Rig& rig);

// Octave in which a corner that is seen at max_distance in octave 0 appears at this distance.
int expected_octave(float max_distance, float distance);

struct SearchOptions {
  float radius = 12.0f;     // pixels at octave 0, times the scale of the octave; for column, row and disparity
  int max_distance = 70;    // bits
  float max_ratio = 0.85f;  // best over second-best distance, within one octave
};

struct FoundFeature {
  int feature = -1;
  int distance = std::numeric_limits<int>::max();  // Hamming bits
  int octave = -1;
};

// The most similar corner near the projection; empty if another corner of its octave is nearly as similar.
std::optional<FoundFeature> find_feature(const Features& features, const Descriptor& descriptor,
                                         const Projection& projection, const SearchOptions& options);

// A map point that is expected in view.
struct ExpectedPoint {
  PointId id;
  Projection projection;
};

ScratchVector<ExpectedPoint> project_points(const MapView& map, std::span<const PointId> points,
                                            const Pose& camera_from_world, const Rig& rig);

// A feature of a frame that looks like a map point.
struct PointMatch {
  int feature = 0;
  PointId point;
  int distance = 0;  // Hamming bits
};

// At most one match for each expected point and each feature; the more similar point keeps the feature. Ordered by
// feature.
ScratchVector<PointMatch> match_expected(const Features& features, const MapView& map,
                                         std::span<const ExpectedPoint> expected, const SearchOptions& options);

}  // namespace byre
