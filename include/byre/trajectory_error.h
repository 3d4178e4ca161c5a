#pragma once

#include "byre/alignment.h"
#include "byre/trajectory.h"

#include <optional>
#include <vector>

namespace byre {

struct ErrorStatistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;  // 95th percentile, interpolated
  double max = 0.0;
  int count = 0;
};

ErrorStatistics summarise(std::vector<double> errors);  // all zero if empty

// Interpolated quantile: share 0 is the minimum, 1 the maximum. Precondition: ascending, not empty.
double quantile(const std::vector<double>& sorted, double share);

// Errors of association. Interpolation: acceleration times squared gap over eight, 2 mm at 5 m/s^2 and 20 Hz. Nearest
// sample: speed times time difference, so only for nominally equal stamps.
struct AssociationOptions {
  Timestamp max_gap = std::chrono::milliseconds(60);        // largest gap between interpolated truth samples
  Timestamp max_difference = std::chrono::milliseconds(2);  // largest distance to the nearest sample
  Timestamp time_offset{0};                                 // added to the stamps of the truth, for a known clock error
};

// Estimated and true pose at the same time.
struct PosePair {
  Timestamp time{};
  Pose estimated_world_from_body;
  Pose true_world_from_body;
};

// Pairs each estimated pose with the interpolated or nearest true pose. Poses without truth are omitted.
std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& truth, const AssociationOptions& options);

struct AbsoluteTrajectoryError {
  ErrorStatistics translation;  // metres, after alignment
  ErrorStatistics rotation;     // degrees, after alignment
  Similarity truth_from_estimate;
  std::vector<double> errors;  // metres, one per pair
};

// Position error after alignment of the estimate to the truth (Sturm 2012). Empty if alignment is impossible.
std::optional<AbsoluteTrajectoryError> absolute_trajectory_error(const std::vector<PosePair>& pairs, Scale scale);

// Error under a given alignment; identity for a map that is aligned already.
AbsoluteTrajectoryError absolute_trajectory_error(const std::vector<PosePair>& pairs,
                                                  const Similarity& truth_from_estimate);

// Estimated pose after alignment to the truth.
Pose aligned(const Similarity& truth_from_estimate, const Pose& world_from_body);

struct RelativePoseError {
  ErrorStatistics translation;  // metres
  ErrorStatistics rotation;     // degrees
};

// Relative pose error E = inv(inv(Q_i) Q_j) (inv(P_i) P_j) (Sturm 2012), over one frame, an interval of time, or a
// length of the true path. scale multiplies the estimated translations. Each pose is paired with the one nearest to the
// interval or length; pairs that differ from it by more than 10 % are omitted.
RelativePoseError relative_pose_error_by_frame(const std::vector<PosePair>& pairs, double scale);
RelativePoseError relative_pose_error_by_time(const std::vector<PosePair>& pairs, Timestamp interval, double scale);
RelativePoseError relative_pose_error_by_distance(const std::vector<PosePair>& pairs, double metres, double scale);

double path_length(const Trajectory& trajectory);  // metres

// Share of frames with an estimated pose. An error alone flatters a trajectory that omits the hard parts.
struct Coverage {
  int expected = 0;   // frames that should have a pose
  int with_pose = 0;  // expected frames that have one

  double share() const { return expected > 0 ? static_cast<double>(with_pose) / expected : 0.0; }
};

// Coverage of given frames: an estimated pose within 1 ms. Precondition: ascending times.
Coverage coverage_of_frames(const Trajectory& estimate, const std::vector<Timestamp>& frame_times);

// Coverage without frame times: expects the span of the truth divided by the median interval of the estimate. A
// trajectory of regularly chosen frames counts as complete. Empty for fewer than two poses or a truth without a span.
std::optional<Coverage> coverage_of_span(const Trajectory& estimate, const Trajectory& truth, Timestamp time_offset);

}  // namespace byre
