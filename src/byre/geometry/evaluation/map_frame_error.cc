#include "byre/geometry/evaluation/map_frame_error.h"

#include "byre/geometry/decompositions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace byre {
namespace {

template <typename Of>
ErrorStatistics statistics_of(const std::vector<PoseError>& errors, Of of) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const PoseError& error : errors) values.push_back((error.*of)());
  return summarise(std::move(values));
}

PoseError error_of(const PosePair& pair, const Pose& estimated) {
  return {pair.time, log_pose(inverse(estimated) * pair.true_world_from_body)};
}

// Position error of a map's poses, indexed by true position.
class MapDeformation {
 public:
  explicit MapDeformation(const MapAlignment& alignment) {
    for (const PosePair& pair : alignment.path) {
      const Eigen::Vector3d& truth = pair.true_world_from_body.translation;
      const Pose estimated = aligned(alignment.truth_from_map, pair.estimated_world_from_body);
      cells_[cell_of(truth)].push_back({truth, estimated.translation - truth});
    }
  }

  // Error of the nearest pose within kReach; empty without one.
  std::optional<Eigen::Vector3d> at(const Eigen::Vector3d& place) const {
    constexpr int kAround = 1;
    std::optional<Eigen::Vector3d> error;
    double nearest = kReach * kReach;
    const Cell centre = cell_of(place);
    for (int i = -kAround; i <= kAround; ++i) {
      for (int j = -kAround; j <= kAround; ++j) {
        for (int k = -kAround; k <= kAround; ++k)
          look_in({centre[0] + i, centre[1] + j, centre[2] + k}, place, nearest, error);
      }
    }
    return error;
  }

 private:
  using Cell = std::array<int, 3>;
  struct Sample {
    Eigen::Vector3d place;
    Eigen::Vector3d error;
  };
  static constexpr double kReach = 1.0;

  static Cell cell_of(const Eigen::Vector3d& place) {
    const Eigen::Vector3i cell = (place / kReach).array().floor().cast<int>();
    return {cell.x(), cell.y(), cell.z()};
  }

  void look_in(const Cell& cell, const Eigen::Vector3d& place, double& nearest,
               std::optional<Eigen::Vector3d>& error) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end()) return;
    for (const Sample& sample : found->second) {
      const double distance = (sample.place - place).squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      error = sample.error;
    }
  }

  std::map<Cell, std::vector<Sample>> cells_;
};

// A straight path. Its positions determine the rotation about it only by their noise.
struct StraightPath {
  Eigen::Vector3d true_centroid;
  Eigen::Vector3d middle;     // in the map
  Eigen::Vector3d direction;  // in the truth
};

std::optional<StraightPath> straight_path(const std::vector<PosePair>& pairs) {
  constexpr double kWidest = 0.1;  // metres, root mean square distance from the line
  const double share = 1.0 / static_cast<double>(pairs.size());
  StraightPath path{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (const PosePair& pair : pairs) {
    path.true_centroid += share * pair.true_world_from_body.translation;
    path.middle += share * pair.estimated_world_from_body.translation;
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d from_middle = pair.true_world_from_body.translation - path.true_centroid;
    scatter += share * from_middle * from_middle.transpose();
  }
  const auto [left, spread, right] = singular_values(scatter);
  if (!(spread[0] > kWidest * kWidest) || spread[1] + spread[2] > kWidest * kWidest) return std::nullopt;
  path.direction = left.col(0);
  return path;
}

// Direction from positions, rotation about it from orientations.
std::optional<Similarity> fit_to_straight_path(const StraightPath& path, const std::vector<PosePair>& pairs,
                                               Scale scale) {
  Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
  Eigen::Vector3d scaled_direction = Eigen::Vector3d::Zero();  // direction in the map, times the squared true length
  double squared_length = 0.0;                                 // squared true length
  for (const PosePair& pair : pairs) {
    turns +=
        (pair.true_world_from_body.rotation * pair.estimated_world_from_body.rotation.conjugate()).toRotationMatrix();
    const double along = path.direction.dot(pair.true_world_from_body.translation - path.true_centroid);
    scaled_direction += along * (pair.estimated_world_from_body.translation - path.middle);
    squared_length += along * along;
  }
  if (!(scaled_direction.norm() > 0.0)) return std::nullopt;
  const Eigen::Quaterniond by_orientations = nearest_rotation(turns);
  const Eigen::Quaterniond rotation =
      rotation_between(by_orientations * scaled_direction.normalized(), path.direction) * by_orientations;
  const double factor = scale == Scale::free ? squared_length / scaled_direction.norm() : 1.0;
  return Similarity{factor, {rotation.normalized(), path.true_centroid - rotation * (factor * path.middle)}};
}

}  // namespace

double PoseError::rotation() const {
  return delta.tail<3>().norm() * 180.0 / std::numbers::pi;
}

MapAlignment align_to_truth(const Trajectory& world_from_body, Scale scale, const Trajectory& map_truth) {
  constexpr std::size_t kFewestPoses = 3;
  const std::vector<PosePair> pairs = associate(world_from_body, map_truth, {});
  if (pairs.size() < kFewestPoses) return {};
  if (const auto path = straight_path(pairs)) {
    const auto fit = fit_to_straight_path(*path, pairs, scale);
    return fit ? MapAlignment{*fit, static_cast<int>(pairs.size()), pairs} : MapAlignment{};
  }
  const auto error = absolute_trajectory_error(pairs, scale);
  if (!error) return {};
  return {error->truth_from_estimate, static_cast<int>(pairs.size()), pairs};
}

std::vector<PoseError> errors_in_map(const Trajectory& world_from_body, const Trajectory& truth,
                                     const MapAlignment& alignment) {
  std::vector<PoseError> errors;
  for (const PosePair& pair : associate(world_from_body, truth, {})) {
    errors.push_back(error_of(pair, aligned(alignment.truth_from_map, pair.estimated_world_from_body)));
  }
  return errors;
}

std::vector<PoseError> errors_of_map(const MapAlignment& alignment) {
  std::vector<PoseError> errors;
  for (const PosePair& pair : alignment.path) {
    errors.push_back(error_of(pair, aligned(alignment.truth_from_map, pair.estimated_world_from_body)));
  }
  return errors;
}

std::vector<PoseError> errors_relative_to_map(const Trajectory& world_from_body, const Trajectory& truth,
                                              const MapAlignment& alignment) {
  const MapDeformation deformation(alignment);
  std::vector<PoseError> errors;
  for (const PosePair& pair : associate(world_from_body, truth, {})) {
    const auto of_map = deformation.at(pair.true_world_from_body.translation);
    if (!of_map) continue;
    Pose estimated = aligned(alignment.truth_from_map, pair.estimated_world_from_body);
    estimated.translation -= *of_map;
    errors.push_back(error_of(pair, estimated));
  }
  return errors;
}

const PoseError* find_error(const std::vector<PoseError>& errors, Timestamp time) {
  const auto found = std::ranges::lower_bound(errors, time, {}, &PoseError::time);
  return found != errors.end() && found->time == time ? &*found : nullptr;
}

ErrorStatistics position_statistics(const std::vector<PoseError>& errors) {
  return statistics_of(errors, &PoseError::position);
}

ErrorStatistics rotation_statistics(const std::vector<PoseError>& errors) {
  return statistics_of(errors, &PoseError::rotation);
}

}  // namespace byre
