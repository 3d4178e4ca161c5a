#include "byre/odometry/time_offset.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <vector>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kStep = 20ms;
constexpr int kSteps = 10;              // either way
constexpr int kStepsAround = 2;         // either way of the earlier estimate
constexpr double kMostError = 0.03;     // radians; larger errors, as by slip, are clipped
constexpr double kLeastTurnSeen = 1.5;  // radians, sum of all turns

double turn_of(const VisualMotion& motion, const Eigen::Vector3d& up) {
  return rotation_log(motion.body.rotation).dot(up);
}

// Mean squared difference between turns from images and from wheels; empty if wheels measure too few of them.
std::optional<double> difference(const std::deque<VisualMotion>& seen, const Eigen::Vector3d& up,
                                 const WheelTrack& wheels, Timestamp offset) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const VisualMotion& motion : seen) {
    const auto measured = wheels.between(motion.earlier + offset, motion.later + offset);
    if (!measured) continue;
    const double error = std::abs(rotation_log(measured->rotation).z() - turn_of(motion, up));
    sum += std::pow(std::min(error, kMostError), 2);
    ++count;
  }
  return 2 * count > seen.size() ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

}  // namespace

std::optional<double> find_time_offset(const std::deque<VisualMotion>& seen, const Eigen::Vector3d& up,
                                       const WheelTrack& wheels, std::optional<double> known) {
  double turned = 0.0;
  for (const VisualMotion& motion : seen) turned += std::abs(turn_of(motion, up));
  if (turned < kLeastTurnSeen) return {};
  const int middle = known ? static_cast<int>(std::lround(*known / to_seconds(kStep))) : 0;
  const int reach = known ? kStepsAround : kSteps;
  const int first = std::clamp(middle - reach, -kSteps, kSteps), last = std::clamp(middle + reach, -kSteps, kSteps);
  std::vector<double> cost;
  for (int step = first; step <= last; ++step) {
    const auto value = difference(seen, up, wheels, step * kStep);
    if (!value) return {};
    cost.push_back(*value);
  }
  const auto least = std::ranges::min_element(cost);
  const int best = first + static_cast<int>(least - cost.begin());
  if (std::abs(best) == kSteps) return {};
  if (best == first || best == last) return best * to_seconds(kStep);
  const double before = *std::prev(least), after = *std::next(least);
  const double curvature = before - 2.0 * *least + after;
  const double beside = curvature > 0.0 ? 0.5 * (before - after) / curvature : 0.0;
  return (best + beside) * to_seconds(kStep);
}

}  // namespace byre
