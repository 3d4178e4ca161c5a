#include "byre/odometry/wheel_estimate.h"

#include "byre/odometry/odometry_calibration.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace byre {

std::vector<MotionPair> pairs_of(const std::deque<VisualMotion>& seen, const CalibratedOdometry& odometry) {
  std::vector<MotionPair> pairs;
  for (const VisualMotion& motion : seen) {
    if (const auto base = base_between(odometry, motion.earlier, motion.later)) pairs.push_back({*base, motion.body});
  }
  return pairs;
}

double way_of(const std::vector<MotionPair>& motions) {
  double way = 0.0;
  for (const MotionPair& motion : motions) way += motion.base.translation.norm();
  return way;
}

bool determine_calibration(const std::vector<MotionPair>& motions) {
  constexpr double kLeastTurn = 0.8;  // radians, sum of all turns
  constexpr double kLeastWay = 0.5;   // metres
  double turned = 0.0;
  for (const MotionPair& motion : motions) turned += std::abs(rotation_log(motion.base.rotation).z());
  return turned >= kLeastTurn && way_of(motions) >= kLeastWay;
}

bool is_determined(const std::optional<WheelCalibration>& calibration, double max_sigma) {
  return calibration && calibration->scale_sigma() < max_sigma && calibration->heading_sigma() < max_sigma;
}

std::optional<WheelCalibration> estimate_without_prior(const std::vector<MotionPair>& motions) {
  if (!determine_calibration(motions)) return {};
  auto found = estimate_wheel_calibration(motions);
  return is_determined(found, kMaxEstimateSigma) ? found : std::nullopt;
}

std::optional<WheelCalibration> estimate_with_prior(const std::vector<MotionPair>& motions,
                                                    const WheelCalibration& prior) {
  auto found = estimate_wheel_calibration(motions, prior);
  return is_determined(found, kMaxEstimateSigma) ? found : std::nullopt;
}

std::optional<WheelCalibration> better_without_prior(const std::vector<MotionPair>& motions,
                                                     const WheelCalibration& prior) {
  constexpr double kClearly = 2.0;  // ratio of the usual errors
  const auto alone = estimate_wheel_calibration(motions), with = estimate_wheel_calibration(motions, prior);
  const bool is_better = with && is_determined(alone, kMaxFirstEstimateSigma) &&
                         with->translation_error > kClearly * alone->translation_error;
  return is_better ? alone : std::nullopt;
}

double scale_scatter(const std::vector<MotionPair>& motions, const WheelCalibration& whole) {
  constexpr std::size_t kParts = 4;
  const auto boundary = [&](std::size_t part) {
    return motions.begin() + static_cast<std::ptrdiff_t>(part * motions.size() / kParts);
  };
  int parts = 0;
  double information = 0.0, squares = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const auto found = estimate_wheel_calibration({boundary(part), boundary(part + 1)}, with_unknown_scale(whole));
    if (!found) continue;
    const double weight = std::pow(found->scale_sigma(), -2);
    ++parts;
    information += weight;
    squares += weight * std::pow(std::log(found->metres_per_unit / whole.metres_per_unit), 2);
  }
  return parts == 0 ? 0.0 : std::sqrt(squares / (std::max(1, parts - 1) * information));
}

}  // namespace byre
