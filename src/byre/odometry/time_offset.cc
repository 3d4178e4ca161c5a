#include "byre/odometry/time_offset.h"

#include "byre/geometry/median.h"

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

// The same turn from images and from wheels, radians.
struct TurnPair {
  double seen = 0.0;
  double measured = 0.0;
};

// Median ratio of turns from images to those from wheels: a wrong focal length scales the former. One with few turns.
double scale_of_turns(const std::vector<TurnPair>& turns) {
  constexpr double kSmall = 0.08;    // radians, turns with a poorly determined ratio
  constexpr std::size_t kLeast = 4;  // turns
  std::vector<double> ratios;
  for (const TurnPair& turn : turns) {
    if (std::abs(turn.measured) > kSmall) ratios.push_back(turn.seen / turn.measured);
  }
  return ratios.size() < kLeast ? 1.0 : median(std::move(ratios));
}

// Mean squared difference between turns from images and from wheels, up to their scale; empty if wheels measure too few
// of them.
std::optional<double> difference(const std::deque<VisualMotion>& seen, const Eigen::Vector3d& up,
                                 const WheelTrack& wheels, Timestamp offset) {
  std::vector<TurnPair> turns;
  for (const VisualMotion& motion : seen) {
    const auto measured = wheels.between(motion.earlier + offset, motion.later + offset);
    if (measured) turns.push_back({motion.focal_change * turn_of(motion, up), rotation_log(measured->rotation).z()});
  }
  if (2 * turns.size() <= seen.size()) return {};
  const double scale = scale_of_turns(turns);
  double sum = 0.0;
  for (const TurnPair& turn : turns) {
    const double error = std::abs(scale * turn.measured - turn.seen);
    sum += std::pow(std::min(error, kMostError), 2);
  }
  return sum / static_cast<double>(turns.size());
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
