#pragma once

#include "byre/geometry/two_view_match.h"
#include "byre/pose.h"

#include <cstdint>
#include <span>

// What may explain matches between two views, each found by random samples and scored alike (Mur-Artal et al. 2015,
// eq. 2), so that the scores of different models can be compared.
namespace byre {

struct TwoViewSearch {
  int max_iterations = 500;
  double confidence = 0.999;
  std::uint64_t seed = 0;
};

// A model of zero score when none was found.
template <typename Model>
struct TwoViewModel {
  Model second_from_first;
  double score = 0.0;  // up to 2 * 5.99 for a match, none where it disagrees
  int inliers = 0;     // matches that agree in both views (95 %)
};

// The camera turned and did not move, or everything is far away.
TwoViewModel<Eigen::Quaterniond> search_rotation(std::span<const TwoViewMatch> matches, const TwoViewSearch& search);

// Everything lies in a plane, or is far away. Scaled as by fit_homography.
TwoViewModel<Eigen::Matrix3d> search_homography(std::span<const TwoViewMatch> matches, const TwoViewSearch& search);

// The camera moved in a scene of any shape. One of the four motions of the essential matrix, its translation of unit
// length: which of them is not told by lines alone.
TwoViewModel<Pose> search_essential(std::span<const TwoViewMatch> matches, const TwoViewSearch& search);

// The Sampson error of a match, squared sigmas (Hartley and Zisserman 2004, eq. 11.9).
double epipolar_error(const Eigen::Matrix3d& essential, const TwoViewMatch& match);

// Matches with a larger epipolar_error disagree: 95 % of chi-square, one degree of freedom.
inline constexpr double kMaxEpipolarError = 3.84;

// Levenberg-Marquardt on the epipolar errors, those that disagree cut off; never worse than the start. Rotation and
// direction of the translation, which is of unit length before and after.
Pose refine_motion(const Pose& second_from_first, std::span<const TwoViewMatch> matches);

// How well the matches that agree determine the direction of the translation: standard deviation where it is least
// determined, radians. Infinite where they leave the motion open.
double direction_sigma(const Pose& second_from_first, std::span<const TwoViewMatch> matches);

}  // namespace byre
