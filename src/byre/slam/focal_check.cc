#include "byre/slam/focal_check.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

std::optional<double> cost_with(double factor, const Pose& camera_from_world, Rig rig,
                                std::span<const PoseObservation> observations, const PoseRefinementOptions& options) {
  constexpr double kMaxSquaredError = 16.0;  // pixels: what is farther off is something else
  rig.focal *= factor;
  const auto refined = refine_pose(camera_from_world, rig, observations, options);
  if (!refined) return std::nullopt;
  double sum = 0.0;
  for (const PoseObservation& observation : observations) {
    const Eigen::Vector3d point_in_camera = refined->camera_from_world * observation.point_in_world;
    const double squared = point_in_camera.z() > 0.0
                               ? (observation.measured - rig.project(point_in_camera)).head<2>().squaredNorm()
                               : kMaxSquaredError;
    sum += std::min(squared, kMaxSquaredError);
  }
  return sum;
}

}  // namespace

std::optional<FocalEvidence> weigh_focal_lengths(const Pose& camera_from_world, const Rig& rig,
                                                 std::span<const PoseObservation> observations,
                                                 const PoseRefinementOptions& options) {
  const auto cost = [&](double factor) { return cost_with(factor, camera_from_world, rig, observations, options); };
  const auto shorter = cost(1.0 - kFocalStep), as_it_is = cost(1.0), longer = cost(1.0 + kFocalStep);
  if (!shorter || !as_it_is || !longer) return std::nullopt;
  return FocalEvidence{*shorter, *as_it_is, *longer};
}

bool FocalCheck::is_due() {
  const int frame = frames_++;
  return asked_ < options_.asked_first || frame % options_.asked_every == 0;
}

void FocalCheck::note(const FocalEvidence& evidence, std::size_t points) {
  if (points < static_cast<std::size_t>(options_.min_points)) return;
  ++asked_;
  const auto blend = [this](double& sum, double now) { sum = options_.memory * sum + now; };
  blend(sum_.shorter, evidence.shorter);
  blend(sum_.as_it_is, evidence.as_it_is);
  blend(sum_.longer, evidence.longer);
}

// The lowest point of the parabola through the three; beyond them where they do not enclose it.
double FocalCheck::error() const {
  const double curvature = sum_.shorter + sum_.longer - 2.0 * sum_.as_it_is;
  const double slope = sum_.longer - sum_.shorter;
  if (slope == 0.0) return 0.0;
  if (std::abs(slope) >= 2.0 * curvature) return std::copysign(kFocalStep, slope);
  return 0.5 * kFocalStep * slope / curvature;
}

bool FocalCheck::is_off() const {
  return std::abs(error()) > options_.max_error;
}

}  // namespace byre
