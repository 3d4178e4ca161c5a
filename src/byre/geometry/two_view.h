#pragma once

#include "byre/geometry/two_view_models.h"
#include "byre/two_view_failure.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace byre {

inline constexpr int kMinTwoViewMatches = 100;  // fewest matches for an estimate

struct TwoViewMotion {
  Pose second_from_first;  // translation of unit length
  // One per match, triangulated: empty for outliers and for rays that do not meet in front of both cameras.
  std::vector<std::optional<Eigen::Vector3d>> points_in_first;
  int point_count = 0;
  bool is_planar = false;  // a homography explains the matches
};

// Parallax from which a motion is accepted: one degree in the median of all points, or also 1.5 degrees of the nearest
// 50. A camera that moves forward sees mostly far points, and loses the first view before their median suffices. least:
// one degree of the nearest 50.
enum class StartParallax : std::uint8_t { of_median, of_nearest_points, least };

// Bounds of the difference between a motion by images and the same by odometry.
struct MotionBounds {
  double turn = 0.1;        // radians
  double direction = 0.35;  // radians between the translations, by a mounting measured by hand
};

// False if either translation is zero. Lengths are not compared.
bool agrees(const Pose& seen, const Pose& measured, const MotionBounds& bounds = {});

struct TwoViewEstimate {
  std::optional<TwoViewMotion> motion;  // empty on failure
  TwoViewFailure failure = TwoViewFailure::none;
};

// Motion between two views of an unknown scene. A homography and an essential matrix are fitted and their scores
// compared (Mur-Artal et al. 2015, eq. 2 and 3), which detects pure rotation. Of the motions of both models the one
// with the best score of inliers in front of both cameras is chosen. It is accepted only with enough parallax and
// without a rival motion that explains the matches nearly as well.
// measured: second_from_first by odometry, its translation of any length but zero; one more motion starts from it. If a
// motion near it explains the matches nearly as well as the best, the others are no rivals, nor is a rotation.
TwoViewEstimate estimate_two_view_motion(std::span<const TwoViewMatch> matches,
                                         StartParallax required = StartParallax::of_nearest_points,
                                         const std::optional<Pose>& measured = {});

}  // namespace byre
