#include "byre/geometry/two_view.h"

#include "byre/base/enum_names.h"
#include "byre/geometry/essential.h"
#include "byre/geometry/homography.h"
#include "byre/geometry/median.h"
#include "byre/geometry/triangulation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

namespace byre {
namespace {

constexpr double kMinParallax = 0.0175;   // radians (one degree)
constexpr int kMinPoints = 80;            // triangulated points in front of both cameras
constexpr double kMinPlanarShare = 0.40;  // homography's share of both scores above which the scene is planar
constexpr double kRotationShare = 0.9;    // share of the homography's score from which a rotation suffices
constexpr double kRivalShare = 0.9;       // share of the best score from which another motion is a rival

using Matches = std::span<const TwoViewMatch>;

struct Models {
  TwoViewModel<Eigen::Quaterniond> rotation;
  TwoViewModel<Eigen::Matrix3d> homography;
  TwoViewModel<Pose> essential;
};

Models search_models(Matches matches) {
  constexpr TwoViewSearch search{};
  return {search_rotation(matches, search), search_homography(matches, search), search_essential(matches, search)};
}

// Mur-Artal et al. 2015, eq. 3. Errors are in sigmas of both views; an exact plane then has a share of 0.45.
bool is_planar(const Models& models) {
  return models.homography.score > kMinPlanarShare * (models.homography.score + models.essential.score);
}

// Motions of both models, since one may find a rival that the other misses. Refinement uses points off the plane too,
// which discriminates the motions of a homography.
std::vector<Pose> motions_of(const Models& models, Matches matches) {
  std::vector<Pose> motions = motions_from_homography(models.homography.second_from_first);
  std::ranges::copy(motions_from_essential(essential_of(models.essential.second_from_first)),
                    std::back_inserter(motions));
  for (Pose& motion : motions) motion = refine_motion(motion, matches);
  return motions;
}

double parallax(const Pose& second_from_first, const TwoViewMatch& match) {
  const Eigen::Vector3d turned = second_from_first.rotation * match.ray_in_first;
  return std::atan2(turned.cross(match.ray_in_second).norm(), turned.dot(match.ray_in_second));
}

// A motion and its score: the epipolar score of a model, over matches that do not meet behind a camera.
struct MotionCandidate {
  TwoViewMotion motion;
  double score = 0.0;
  std::vector<double> parallaxes;  // radians, of the inliers
};

// Nearly parallel rays may meet behind the cameras by noise alone.
bool is_far(double match_parallax, const TwoViewMatch& match) {
  return match_parallax < 4.0 * match.sigma;
}

MotionCandidate weigh(const Pose& second_from_first, Matches matches) {
  const Eigen::Matrix3d essential = essential_of(second_from_first);
  MotionCandidate candidate{{.second_from_first = second_from_first, .points_in_first = {}}, 0.0, {}};
  for (const TwoViewMatch& match : matches) {
    auto& point = candidate.motion.points_in_first.emplace_back();
    const double error = epipolar_error(essential, match);
    if (!(error < kMaxEpipolarError)) continue;
    point = triangulate(match.ray_in_first, match.ray_in_second, second_from_first, 0.0);
    const double match_parallax = parallax(second_from_first, match);
    if (!point && !is_far(match_parallax, match)) continue;
    candidate.motion.point_count += point.has_value();
    candidate.score += kMaxEpipolarError - error;
    candidate.parallaxes.push_back(match_parallax);
  }
  return candidate;
}

// Value of this rank from the largest, which has rank 1; 0 for fewer values.
double largest(std::vector<double> values, std::size_t rank) {
  if (values.size() < rank) return 0.0;
  const auto wanted = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::ranges::nth_element(values, wanted, std::greater<>());
  return *wanted;
}

// Errors of a rotation by calibration and rolling shutter resemble parallax, so that of the nearest points must exceed
// the rotation.
bool has_parallax(const MotionCandidate& candidate, StartParallax required) {
  constexpr std::size_t kNearest = 50;  // points
  const double turn = rotation_log(candidate.motion.second_from_first.rotation).norm();
  const double of_nearest = required == StartParallax::least ? kMinParallax : 1.5 * kMinParallax;
  return median_or(candidate.parallaxes, 0.0) >= kMinParallax ||
         (required != StartParallax::of_median &&
          largest(candidate.parallaxes, kNearest) >= std::max(of_nearest, turn));
}

// Refinement on points off the plane may bring two motions of a homography together.
bool is_same_motion(const Pose& first, const Pose& second) {
  constexpr double kMaxTurn = 0.005;  // radians
  constexpr double kMaxShift = 0.05;  // relative to the translation's unit length
  return angle_between(first.rotation, second.rotation) < kMaxTurn &&
         (first.translation - second.translation).norm() < kMaxShift;
}

bool has_rival(const MotionCandidate& best, const std::vector<MotionCandidate>& candidates) {
  return std::ranges::any_of(candidates, [&](const MotionCandidate& candidate) {
    return candidate.score > kRivalShare * best.score &&
           !is_same_motion(candidate.motion.second_from_first, best.motion.second_from_first);
  });
}

// Leaves the motions that agree with the measured one, if they explain the matches nearly as well as the best. Returns
// whether any does.
bool prefer_measured(std::vector<MotionCandidate>& candidates, const Pose& measured) {
  const double best = std::ranges::max_element(candidates, {}, &MotionCandidate::score)->score;
  const auto is_good = [&](const MotionCandidate& candidate) {
    return candidate.score > kRivalShare * best && agrees(candidate.motion.second_from_first, measured);
  };
  if (std::ranges::none_of(candidates, is_good)) return false;
  std::erase_if(candidates, std::not_fn(is_good));
  return true;
}

TwoViewFailure rejection_reason(const Models& models, bool planar) {
  const int inliers = planar ? models.homography.inliers : models.essential.inliers;
  if (inliers < kMinPoints) return TwoViewFailure::no_common_motion;
  const bool turned = models.rotation.score > kRotationShare * models.homography.score;
  return planar && turned ? TwoViewFailure::rotation_only : TwoViewFailure::none;
}

TwoViewFailure rejection_reason(const MotionCandidate& best, const std::vector<MotionCandidate>& candidates,
                                StartParallax required) {
  if (!has_parallax(best, required)) return TwoViewFailure::small_parallax;
  if (has_rival(best, candidates)) return TwoViewFailure::planar_ambiguity;
  return best.motion.point_count < kMinPoints ? TwoViewFailure::too_few_points : TwoViewFailure::none;
}

TwoViewEstimate failed(TwoViewFailure failure) {
  return {std::nullopt, failure};
}

}  // namespace

bool agrees(const Pose& seen, const Pose& measured, const MotionBounds& bounds) {
  const double lengths = measured.translation.norm() * seen.translation.norm();
  return lengths > 0.0 && angle_between(measured.rotation, seen.rotation) < bounds.turn &&
         measured.translation.dot(seen.translation) > lengths * std::cos(bounds.direction);
}

std::string_view to_string(TwoViewFailure failure) {
  return name_among<TwoViewFailure::uncertain>(
      {"none", "too few matches", "no common motion", "rotation only", "small parallax", "planar ambiguity",
       "too few points", "motion is uncertain"},
      failure);
}

TwoViewEstimate estimate_two_view_motion(std::span<const TwoViewMatch> matches, StartParallax required,
                                         const std::optional<Pose>& measured) {
  if (static_cast<int>(matches.size()) < kMinTwoViewMatches) return failed(TwoViewFailure::too_few_matches);
  const Models models = search_models(matches);
  const bool planar = is_planar(models);
  const TwoViewFailure doubt = rejection_reason(models, planar);
  if (doubt != TwoViewFailure::none && !measured) return failed(doubt);
  std::vector<MotionCandidate> candidates;
  for (const Pose& motion : motions_of(models, matches)) candidates.push_back(weigh(motion, matches));
  if (measured) {
    const Pose unit{measured->rotation, measured->translation.normalized()};
    candidates.push_back(weigh(refine_motion(unit, matches), matches));
    if (!prefer_measured(candidates, unit) && doubt != TwoViewFailure::none) return failed(doubt);
  }
  MotionCandidate best = *std::ranges::max_element(candidates, {}, &MotionCandidate::score);
  const TwoViewFailure failure = rejection_reason(best, candidates, required);
  if (failure != TwoViewFailure::none) return failed(failure);
  best.motion.is_planar = planar;
  return {std::move(best.motion), TwoViewFailure::none};
}

}  // namespace byre
