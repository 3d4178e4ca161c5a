#include "byre/motion/time_offset.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kStep = 20ms;
constexpr int kSteps = 10;           // either way
constexpr double kMostError = 0.03;  // radians that count: where a wheel slips, no offset makes up for it
constexpr double kLeastTurn = 1.5;   // radians, all turns together

double turn_of(const SeenMotion& motion, const Eigen::Vector3d& up) {
  return rotation_log(motion.body.rotation).dot(up);
}

// Sum of squared differences between turns seen and told, per turn that both tell; empty where wheels tell too few.
std::optional<double> difference(const std::deque<SeenMotion>& seen, const Eigen::Vector3d& up,
                                 const WheelTrack& wheels, Timestamp offset) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const SeenMotion& motion : seen) {
    const auto told = wheels.between(motion.earlier + offset, motion.later + offset);
    if (!told) continue;
    const double error = std::abs(rotation_log(told->rotation).z() - turn_of(motion, up));
    sum += std::pow(std::min(error, kMostError), 2);
    ++count;
  }
  return 2 * count > seen.size() ? std::optional(sum / static_cast<double>(count)) : std::nullopt;
}

}  // namespace

std::optional<double> find_time_offset(const std::deque<SeenMotion>& seen, const Eigen::Vector3d& up,
                                       const WheelTrack& wheels) {
  double turned = 0.0;
  for (const SeenMotion& motion : seen) turned += std::abs(turn_of(motion, up));
  if (turned < kLeastTurn) return {};
  std::array<double, 2 * kSteps + 1> cost{};
  int best = 0;
  for (int step = -kSteps; step <= kSteps; ++step) {
    const auto index = static_cast<std::size_t>(step + kSteps);
    const auto value = difference(seen, up, wheels, step * kStep);
    if (!value) return {};
    cost[index] = *value;
    if (cost[index] < cost[static_cast<std::size_t>(best + kSteps)]) best = step;
  }
  if (std::abs(best) == kSteps) return {};
  const auto middle = static_cast<std::size_t>(best + kSteps);
  const double before = cost[middle - 1], after = cost[middle + 1];
  const double curvature = before - 2.0 * cost[middle] + after;
  const double beside = curvature > 0.0 ? 0.5 * (before - after) / curvature : 0.0;
  return (best + beside) * to_seconds(kStep);
}

}  // namespace byre
