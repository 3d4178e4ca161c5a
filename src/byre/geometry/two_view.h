#pragma once

#include "byre/geometry/two_view_models.h"
#include "byre/two_view_failure.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

inline constexpr int kMinTwoViewMatches = 100;  // matches from which a motion is looked for
inline constexpr double kMinParallax = 0.0175;  // radians, median over the matches that agree: a degree

struct TwoViewMotion {
  Pose second_from_first;  // translation of unit length
  // One per match: where the rays of a match that agrees with the motion meet in front of both cameras, in the first.
  std::vector<std::optional<Eigen::Vector3d>> points_in_first;
  int point_count = 0;
  double median_parallax = 0.0;  // radians, of all matches that agree with the motion
  bool is_planar = false;        // a homography explains the matches
};

struct TwoViewEstimate {
  std::optional<TwoViewMotion> motion;  // empty when there is a failure
  TwoViewFailure failure = TwoViewFailure::none;
};

// The motion between two views of an unknown scene. Homography and essential matrix are fitted side by side and their
// scores compared (Mur-Artal et al. 2015, eq. 2 and 3), which tells a turn on the spot. Of the motions that both stand
// for the one is chosen that explains most matches in front of both cameras. Believed only when the parallax is enough
// and no other motion explains the matches nearly as well.
TwoViewEstimate estimate_two_view_motion(std::span<const TwoViewMatch> matches);

}  // namespace byre
