#pragma once

#include "byre/map/map_view.h"

#include <optional>
#include <vector>

namespace byre {

// Where a view should show a map point.
struct Projection {
  StereoPixel predicted;  // u, v, disparity; pixels
  int octave = 0;         // octave in which its corner should be found
};

// Empty outside the camera's frustum, and where distance or angle are such that the descriptor no longer holds.
std::optional<Projection> project_point(const MapPoint& point, const Pose& camera_from_world,
                                        const Eigen::Vector3d& camera_in_world, const Rig& rig);

// The octave in which a corner seen at max_distance in octave 0 appears at this distance.
int expected_octave(float max_distance, float distance);

struct SearchOptions {
  float radius = 12.0f;     // pixels at octave 0, times the octave's scale; of column, row and disparity
  int max_distance = 70;    // bits
  float max_ratio = 0.85f;  // best over second best, where both are of one octave
};

struct FoundFeature {
  int feature = -1;
  int distance = 0;  // Hamming bits
};

// The corner near the projection that looks most like the descriptor, unless another of its octave is nearly as alike.
std::optional<FoundFeature> find_feature(const Features& features, const Descriptor& descriptor,
                                         const Projection& projection, const SearchOptions& options);

// A map point that should be in view, and where.
struct ExpectedPoint {
  PointId id;
  Projection projection;
};

// Refills `expected`.
void project_points(const MapView& map, std::span<const PointId> points, const Pose& camera_from_world, const Rig& rig,
                    std::vector<ExpectedPoint>& expected);

struct GuidedMatch {
  int feature = 0;
  PointId point;
  int distance = 0;  // Hamming bits
};

// One match at most for each expected point and each feature (the more similar point keeps it). Ordered by feature.
// Refills `matches`.
void match_expected(const Features& features, const MapView& map, const std::vector<ExpectedPoint>& expected,
                    const SearchOptions& options, std::vector<GuidedMatch>& matches);

}  // namespace byre
