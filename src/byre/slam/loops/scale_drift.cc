#include "byre/slam/loops/scale_drift.h"

#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

struct LogRatio {
  double value = 0.0;
  double sigma = 0.0;
};

// Relative variance of the depth.
double relative_depth_variance(const MapPoint& point, const Pose& camera_from_world, double depth) {
  const Eigen::RowVector3d forward_in_world = camera_from_world.rotation.toRotationMatrix().row(2);
  return forward_in_world.dot(point.covariance * forward_in_world.transpose()) / (depth * depth);
}

std::vector<LogRatio> log_ratios(std::span<const DepthPair> pairs) {
  std::vector<LogRatio> ratios;
  for (const DepthPair& pair : pairs) ratios.push_back({std::log(pair.older / pair.newer), pair.sigma});
  return ratios;
}

// Robust spread of the ratios around a centre, in their own sigmas; at least 1.
double spread_about(double centre, const std::vector<LogRatio>& ratios) {
  std::vector<double> errors;
  for (const LogRatio& ratio : ratios) errors.push_back(std::abs(ratio.value - centre) / ratio.sigma);
  return robust_scale(std::move(errors));
}

}  // namespace

std::vector<DepthPair> depth_pairs(const Map& map, const Keyframe& keyframe, const TrackedFrame& in_older_part) {
  constexpr double kMinVariance = 0.005 * 0.005;  // lower bound, whatever the covariance
  std::vector<DepthPair> pairs;
  for (const TrackedFeature& feature : in_older_part.features) {
    const auto& own = keyframe.sightings[static_cast<std::size_t>(feature.feature)].point;
    const MapPoint* const newer = own && *own != feature.point ? map.find_point(*own) : nullptr;
    const MapPoint* const older = map.find_point(feature.point);
    if (newer == nullptr || older == nullptr) continue;
    const double newer_depth = (keyframe.camera_from_world * newer->position_in_world).z();
    const double older_depth = (in_older_part.camera_from_world * older->position_in_world).z();
    if (newer_depth <= 0.0 || older_depth <= 0.0) continue;
    const double variance = relative_depth_variance(*newer, keyframe.camera_from_world, newer_depth) +
                            relative_depth_variance(*older, in_older_part.camera_from_world, older_depth);
    pairs.push_back({newer_depth, older_depth, std::sqrt(variance + kMinVariance)});
  }
  return pairs;
}

std::optional<ScaleDrift> estimate_scale_drift(std::span<const DepthPair> pairs, int min_pairs) {
  constexpr double kMaxError = 3.0;  // spreads
  std::vector<LogRatio> ratios = log_ratios(pairs);
  if (ratios.empty()) return std::nullopt;
  std::vector<double> values;
  for (const LogRatio& ratio : ratios) values.push_back(ratio.value);
  const double centre = median(std::move(values));
  const double spread = spread_about(centre, ratios);
  std::erase_if(
      ratios, [&](const LogRatio& ratio) { return std::abs(ratio.value - centre) > kMaxError * spread * ratio.sigma; });
  if (static_cast<int>(ratios.size()) < min_pairs) return std::nullopt;

  double weights = 0.0, weighted = 0.0;
  for (const LogRatio& ratio : ratios) {
    const double weight = 1.0 / (ratio.sigma * ratio.sigma);
    weights += weight;
    weighted += weight * ratio.value;
  }
  return ScaleDrift{std::exp(weighted / weights), spread / std::sqrt(weights)};
}

}  // namespace byre
