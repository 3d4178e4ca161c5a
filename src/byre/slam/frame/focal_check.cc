#include "byre/slam/frame/focal_check.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

// Largest acceptable error, share of the focal length. A worn calibration is off by 0.003. Frames of sound cameras
// measure up to 0.007 in a building and 0.015 hand-held with a rolling shutter, but the latter below two sigmas. With
// an error of 0.05 they measure at least 0.013, at four sigmas: points that would show more are not found at their
// predictions.
constexpr double kMaxError = 0.01;
constexpr double kMinSigmas = 3.0;     // sigmas of a significant error
constexpr double kRelease = 0.5;       // share of both bounds below which a focal length is accepted again
constexpr int kMinFramePoints = 36;    // points in a frame
constexpr int kMinFrames = 3;          // frames weighed: a single view may be of one plane
constexpr double kFocalMemory = 0.85;  // share of earlier evidence kept from frame to frame

double cost_at(const Pose& camera_from_world, const Rig& rig, std::span<const PoseObservation> observations,
               double max_error) {
  const double max_squared = max_error * max_error;
  double sum = 0.0;
  for (const PoseObservation& observation : observations) {
    const Eigen::Vector3d point_in_camera = camera_from_world * observation.point_in_world;
    const double squared = point_in_camera.z() > 0.0
                               ? (observation.measured - rig.project(point_in_camera)).head<2>().squaredNorm()
                               : max_squared;
    sum += std::min(squared, max_squared);
  }
  return sum;
}

// Parabola through the three costs, in steps of the focal length. A bounded cost has negative curvature if many points
// do not fit. The curvature is at least a tenth of the cost, so that nearly flat parabolas are no evidence.
struct Parabola {
  double slope = 0.0;
  double curvature = 0.0;

  explicit Parabola(const FocalEvidence& evidence)
      : slope(0.5 * (evidence.longer - evidence.shorter)),
        curvature(std::max(evidence.shorter + evidence.longer - 2.0 * evidence.present, 0.1 * evidence.present)) {}
};

}  // namespace

std::optional<FocalEvidence> compare_focal_lengths(const Pose& camera_from_world, const Rig& rig,
                                                   std::span<const PoseObservation> observations, double max_error) {
  const auto cost_with = [&](double factor) -> std::optional<double> {
    Rig other = rig;
    other.focal *= factor;
    const auto refined = refine_pose(camera_from_world, other, observations, {});
    return refined ? std::optional(cost_at(refined->camera_from_world, other, observations, max_error)) : std::nullopt;
  };
  const auto shorter = cost_with(1.0 - kFocalStep), longer = cost_with(1.0 + kFocalStep);
  if (!shorter || !longer) return std::nullopt;
  return FocalEvidence{*shorter, cost_at(camera_from_world, rig, observations, max_error), *longer,
                       static_cast<double>(observations.size())};
}

bool FocalCheck::is_due() {
  constexpr int kFirstFrames = 5;
  constexpr int kFrameInterval = 20;
  const int frame = frames_++;
  return checked_ < kFirstFrames || frame % kFrameInterval == 0;
}

void FocalCheck::note(const FocalEvidence& evidence) {
  if (evidence.points < kMinFramePoints) return;
  ++checked_;
  const auto blend = [](double& sum, double now) { sum = kFocalMemory * sum + now; };
  blend(sum_.shorter, evidence.shorter);
  blend(sum_.present, evidence.present);
  blend(sum_.longer, evidence.longer);
  blend(sum_.points, evidence.points);
  blend(weight_, 1.0);
  const double share = is_off_ ? kRelease : 1.0;
  is_off_ = checked_ >= kMinFrames && std::abs(error()) > share * kMaxError && std::abs(sigmas()) > share * kMinSigmas;
}

double FocalCheck::error() const {
  const Parabola cost(sum_);
  return cost.curvature > 0.0 ? kFocalStep * cost.slope / cost.curvature : 0.0;
}

double FocalCheck::sigmas() const {
  const Parabola cost(sum_);
  if (cost.curvature <= 0.0 || sum_.present <= 0.0) return 0.0;
  const double variance = sum_.present / sum_.points;  // variance of a point's error
  return cost.slope / std::sqrt(cost.curvature * variance * weight_);
}

}  // namespace byre
