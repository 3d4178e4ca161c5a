#pragma once

#include "byre/geometry/two_view_match.h"
#include "byre/pose.h"

#include <cstdint>
#include <span>

// Models of matches between two views by RANSAC, with comparable scores (Mur-Artal et al. 2015, eq. 2).
namespace byre {

struct TwoViewSearch {
  int max_iterations = 500;
  double confidence = 0.999;
  std::uint64_t seed = 0;
};

// The score is zero if no model was found.
template <typename Model>
struct TwoViewModel {
  Model second_from_first;
  double score = 0.0;  // up to 2 * 5.99 per match, 0 for outliers
  int inliers = 0;     // matches within the bound (95 %) in both views
};

// Pure rotation, or a distant scene.
TwoViewModel<Eigen::Quaterniond> search_rotation(std::span<const TwoViewMatch> matches, const TwoViewSearch& search);

// A planar or distant scene. Scaled as by fit_homography.
TwoViewModel<Eigen::Matrix3d> search_homography(std::span<const TwoViewMatch> matches, const TwoViewSearch& search);

// General motion. One of the four motions of the essential matrix (epipolar lines do not determine which), with a
// translation of unit length.
TwoViewModel<Pose> search_essential(std::span<const TwoViewMatch> matches, const TwoViewSearch& search);

// Sampson error of a match, squared sigmas (Hartley and Zisserman 2004, eq. 11.9).
double epipolar_error(const Eigen::Matrix3d& essential, const TwoViewMatch& match);

// Bound of epipolar_error for inliers: 95 % of chi-square, one degree of freedom.
inline constexpr double kMaxEpipolarError = 3.84;

// Levenberg-Marquardt on the epipolar errors, truncated at kMaxEpipolarError; never worse than the start. Refines the
// rotation and the direction of the translation, which has unit length before and after.
Pose refine_motion(const Pose& second_from_first, std::span<const TwoViewMatch> matches);

// Standard deviation of the translation's direction along its least determined axis, from the inliers; radians.
// Infinite if they do not determine the motion.
double direction_sigma(const Pose& second_from_first, std::span<const TwoViewMatch> matches);

}  // namespace byre
