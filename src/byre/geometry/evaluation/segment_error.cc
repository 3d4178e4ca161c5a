#include "byre/geometry/evaluation/segment_error.h"

#include "byre/geometry/decompositions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

constexpr std::array kLengths = {100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0};  // metres
constexpr std::size_t kStep = 10;                                                          // poses

std::vector<double> true_distances(const std::vector<PosePair>& pairs) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double step =
        i == 0 ? 0.0
               : (pairs[i].true_world_from_body.translation - pairs[i - 1].true_world_from_body.translation).norm();
    distances.push_back(i == 0 ? 0.0 : distances.back() + step);
  }
  return distances;
}

// Error of the estimated motion from first to last: its correction to the true one.
Pose motion_error(const PosePair& first, const PosePair& last, double scale) {
  Pose estimated = inverse(first.estimated_world_from_body) * last.estimated_world_from_body;
  estimated.translation *= scale;
  return inverse(estimated) * (inverse(first.true_world_from_body) * last.true_world_from_body);
}

void add(const Pose& error, double length, SegmentError& sum) {
  sum.translation += error.translation.norm() / length;
  sum.rotation += rotation_log(error.rotation).norm() * 180.0 / std::numbers::pi / length;
  ++sum.count;
}

SegmentError mean(SegmentError sum) {
  if (sum.count == 0) return sum;
  sum.translation /= sum.count;
  sum.rotation /= sum.count;
  return sum;
}

}  // namespace

SegmentErrors segment_errors(const std::vector<PosePair>& pairs, double scale) {
  const std::vector<double> distances = true_distances(pairs);
  SegmentErrors errors;
  for (const double length : kLengths) {
    SegmentError of_length;
    of_length.length = length;
    for (std::size_t first = 0; first < pairs.size(); first += kStep) {
      const auto last = std::upper_bound(distances.begin(), distances.end(), distances[first] + length);
      if (last == distances.end()) break;
      const PosePair& end = pairs[static_cast<std::size_t>(last - distances.begin())];
      const Pose error = motion_error(pairs[first], end, scale);
      add(error, length, of_length);
      add(error, length, errors.all);
    }
    if (of_length.count > 0) errors.by_length.push_back(mean(of_length));
  }
  errors.all = mean(errors.all);
  return errors;
}

Eigen::Vector3d principal_spread(const std::vector<PosePair>& pairs) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) middle += pair.true_world_from_body.translation;
  middle /= static_cast<double>(pairs.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d offset = pair.true_world_from_body.translation - middle;
    covariance += offset * offset.transpose();
  }
  covariance /= static_cast<double>(pairs.size());
  return symmetric_eigenvalues(covariance).cwiseMax(0.0).cwiseSqrt().reverse();
}

}  // namespace byre
