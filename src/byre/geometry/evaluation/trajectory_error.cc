#include "byre/trajectory_error.h"

#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace byre {
namespace {

constexpr double kIntervalTolerance = 0.1;  // relative to the interval or length
constexpr Timestamp kSameFrame = std::chrono::milliseconds(1);

double to_degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

// The sample nearest to a time, if within max_difference.
std::optional<Pose> nearest_pose(const Trajectory& trajectory, Timestamp time, Timestamp max_difference) {
  const auto after = std::ranges::lower_bound(trajectory, time, {}, &StampedPose::time);
  const StampedPose* nearest = after == trajectory.end() ? nullptr : &*after;
  if (after != trajectory.begin()) {
    const StampedPose* const before = &*std::prev(after);
    if (nearest == nullptr || time - before->time < nearest->time - time) nearest = before;
  }
  if (nearest == nullptr || std::chrono::abs(nearest->time - time) > max_difference) return std::nullopt;
  return nearest->world_from_body;
}

// inv(inv(Q_i) Q_j) (inv(P_i) P_j): the error of the estimated motion.
Pose relative_error(const PosePair& first, const PosePair& second, double scale) {
  Pose estimated_first_from_second = inverse(first.estimated_world_from_body) * second.estimated_world_from_body;
  estimated_first_from_second.translation *= scale;
  const Pose true_first_from_second = inverse(first.true_world_from_body) * second.true_world_from_body;
  return inverse(true_first_from_second) * estimated_first_from_second;
}

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

RelativePoseError relative_pose_error(const std::vector<PosePair>& pairs, const IndexPairs& indices, double scale) {
  std::vector<double> metres;
  std::vector<double> degrees;
  for (const auto& [first, second] : indices) {
    const Pose error = relative_error(pairs[first], pairs[second], scale);
    metres.push_back(error.translation.norm());
    degrees.push_back(to_degrees(rotation_log(error.rotation).norm()));
  }
  return {summarise(std::move(metres)), summarise(std::move(degrees))};
}

// For each of ascending positions, the one nearest to a step beyond it, if within tolerance.
IndexPairs pairs_apart(const std::vector<double>& positions, double step) {
  IndexPairs indices;
  for (std::size_t first = 0; first < positions.size(); ++first) {
    const double wanted = positions[first] + step;
    auto second = std::lower_bound(positions.begin(), positions.end(), wanted);
    if (second == positions.end() || wanted - *std::prev(second) < *second - wanted) --second;
    if (std::abs(*second - wanted) > kIntervalTolerance * step) continue;
    indices.emplace_back(first, static_cast<std::size_t>(second - positions.begin()));
  }
  return indices;
}

double distance(const Pose& first, const Pose& second) {
  return (second.translation - first.translation).norm();
}

Timestamp median_interval(const Trajectory& trajectory) {
  std::vector<Timestamp> intervals;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    intervals.push_back(trajectory[i].time - trajectory[i - 1].time);
  }
  return median(std::move(intervals));
}

}  // namespace

double quantile(const std::vector<double>& sorted, double share) {
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

ErrorStatistics summarise(std::vector<double> errors) {
  if (errors.empty()) return {};
  std::sort(errors.begin(), errors.end());
  const auto count = static_cast<double>(errors.size());
  ErrorStatistics statistics;
  statistics.rmse = std::sqrt(std::inner_product(errors.begin(), errors.end(), errors.begin(), 0.0) / count);
  statistics.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / count;
  statistics.median = quantile(errors, 0.5);
  statistics.p95 = quantile(errors, 0.95);
  statistics.max = errors.back();
  statistics.count = static_cast<int>(errors.size());
  return statistics;
}

std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& truth,
                                const AssociationOptions& options) {
  std::vector<PosePair> pairs;
  for (const StampedPose& sample : estimate) {
    const Timestamp truth_time = sample.time - options.time_offset;
    std::optional<Pose> true_pose = pose_at(truth, truth_time, options.max_gap);
    if (!true_pose) true_pose = nearest_pose(truth, truth_time, options.max_difference);
    if (true_pose) pairs.push_back({sample.time, sample.world_from_body, *true_pose});
  }
  return pairs;
}

Pose aligned(const Similarity& truth_from_estimate, const Pose& world_from_body) {
  return {(truth_from_estimate.target_from_source.rotation * world_from_body.rotation).normalized(),
          truth_from_estimate * world_from_body.translation};
}

std::optional<AbsoluteTrajectoryError> absolute_trajectory_error(const std::vector<PosePair>& pairs, Scale scale) {
  std::vector<Eigen::Vector3d> estimated;
  std::vector<Eigen::Vector3d> truth;
  for (const PosePair& pair : pairs) {
    estimated.push_back(pair.estimated_world_from_body.translation);
    truth.push_back(pair.true_world_from_body.translation);
  }
  const std::optional<Similarity> truth_from_estimate = align(estimated, truth, scale);
  if (!truth_from_estimate) return std::nullopt;
  return absolute_trajectory_error(pairs, *truth_from_estimate);
}

AbsoluteTrajectoryError absolute_trajectory_error(const std::vector<PosePair>& pairs,
                                                  const Similarity& truth_from_estimate) {
  AbsoluteTrajectoryError error;
  error.truth_from_estimate = truth_from_estimate;
  std::vector<double> degrees;
  for (const PosePair& pair : pairs) {
    const Pose estimated = aligned(truth_from_estimate, pair.estimated_world_from_body);
    error.errors.push_back(distance(estimated, pair.true_world_from_body));
    degrees.push_back(to_degrees(angle_between(estimated.rotation, pair.true_world_from_body.rotation)));
  }
  error.translation = summarise(error.errors);
  error.rotation = summarise(std::move(degrees));
  return error;
}

RelativePoseError relative_pose_error_by_frame(const std::vector<PosePair>& pairs, double scale) {
  IndexPairs indices;
  for (std::size_t i = 1; i < pairs.size(); ++i) indices.emplace_back(i - 1, i);
  return relative_pose_error(pairs, indices, scale);
}

RelativePoseError relative_pose_error_by_time(const std::vector<PosePair>& pairs, Timestamp interval, double scale) {
  std::vector<double> seconds;
  for (const PosePair& pair : pairs) seconds.push_back(to_seconds(pair.time - pairs.front().time));
  return relative_pose_error(pairs, pairs_apart(seconds, to_seconds(interval)), scale);
}

RelativePoseError relative_pose_error_by_distance(const std::vector<PosePair>& pairs, double metres, double scale) {
  std::vector<double> travelled;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double step = i == 0 ? 0.0 : distance(pairs[i - 1].true_world_from_body, pairs[i].true_world_from_body);
    travelled.push_back(i == 0 ? 0.0 : travelled.back() + step);
  }
  return relative_pose_error(pairs, pairs_apart(travelled, metres), scale);
}

double path_length(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length += distance(trajectory[i - 1].world_from_body, trajectory[i].world_from_body);
  }
  return length;
}

Coverage coverage_of_frames(const Trajectory& estimate, const std::vector<Timestamp>& frame_times) {
  Coverage coverage{static_cast<int>(frame_times.size()), 0};
  auto sample = estimate.begin();
  for (const Timestamp time : frame_times) {
    while (sample != estimate.end() && sample->time < time - kSameFrame) ++sample;
    if (sample == estimate.end() || sample->time > time + kSameFrame) continue;
    ++coverage.with_pose;
    ++sample;  // each pose counts for one frame only
  }
  return coverage;
}

std::optional<Coverage> coverage_of_span(const Trajectory& estimate, const Trajectory& truth, Timestamp time_offset) {
  if (estimate.size() < 2 || truth.size() < 2) return std::nullopt;
  const Timestamp begin = truth.front().time + time_offset;
  const Timestamp end = truth.back().time + time_offset;
  const double intervals = to_seconds(end - begin) / to_seconds(median_interval(estimate));
  const auto within = std::count_if(estimate.begin(), estimate.end(), [&](const StampedPose& sample) {
    return sample.time >= begin && sample.time <= end;
  });
  const int expected = static_cast<int>(std::lround(intervals)) + 1;
  return Coverage{expected, std::min(static_cast<int>(within), expected)};
}

}  // namespace byre
