#include "byre/evaluation/map_frame_error.h"

#include <algorithm>
#include <numbers>

namespace byre {
namespace {

template <typename Of>
ErrorStatistics statistics_of(const std::vector<PoseError>& errors, Of of) {
  std::vector<double> values;
  values.reserve(errors.size());
  for (const PoseError& error : errors) values.push_back((error.*of)());
  return summarise(std::move(values));
}

}  // namespace

double PoseError::rotation() const {
  return delta.tail<3>().norm() * 180.0 / std::numbers::pi;
}

MapAlignment align_to_truth(const Trajectory& world_from_body, Scale scale, const Trajectory& map_truth) {
  constexpr std::size_t kFewestPoses = 3;
  const std::vector<PosePair> pairs = associate(world_from_body, map_truth, {});
  if (pairs.size() < kFewestPoses) return {};
  const auto error = absolute_trajectory_error(pairs, scale);
  if (!error) return {};
  return {error->truth_from_estimate, static_cast<int>(pairs.size())};
}

std::vector<PoseError> errors_in_map(const Trajectory& world_from_body, const Trajectory& truth,
                                     const MapAlignment& alignment) {
  std::vector<PoseError> errors;
  for (const PosePair& pair : associate(world_from_body, truth, {})) {
    const Pose estimated = aligned(alignment.truth_from_map, pair.estimated_world_from_body);
    errors.push_back({pair.time, log_pose(inverse(estimated) * pair.true_world_from_body)});
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
