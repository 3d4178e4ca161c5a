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
  double p95 = 0.0;  // 95th percentile, interpolated between its neighbours
  double max = 0.0;
  int count = 0;
};

ErrorStatistics summarise(std::vector<double> errors);  // all zero for none

// Interpolated between its neighbours; share 0 is the least, 1 the largest. Precondition: ascending, not empty.
double quantile(const std::vector<double>& sorted, double share);

// Interpolation is off by an eighth of acceleration times squared gap: 2 mm at 5 m/s^2 in truth of 20 Hz. The nearest
// sample is off by speed times difference, and so only stands in for truth at what was meant to be the same instant.
struct AssociationOptions {
  Timestamp max_gap = std::chrono::milliseconds(60);        // largest gap between truth samples that are interpolated
  Timestamp max_difference = std::chrono::milliseconds(2);  // largest distance to a sample where none is interpolated
  Timestamp time_offset{0};  // added to the truth's time stamps, for truth with a known clock error
};

// An estimated pose and the true one at the same time.
struct PosePair {
  Timestamp time{};
  Pose estimated_world_from_body;
  Pose true_world_from_body;
};

// The truth interpolated at each estimated time, or its nearest sample; poses without truth are left out.
std::vector<PosePair> associate(const Trajectory& estimate, const Trajectory& truth, const AssociationOptions& options);

struct AbsoluteTrajectoryError {
  ErrorStatistics translation;  // metres, after alignment
  ErrorStatistics rotation;     // degrees, after alignment
  Similarity truth_from_estimate;
  std::vector<double> errors;  // metres, one per pair
};

// Position error after aligning the estimate to the truth (Sturm 2012). Empty when alignment is impossible.
std::optional<AbsoluteTrajectoryError> absolute_trajectory_error(const std::vector<PosePair>& pairs, Scale scale);

// The error under a given alignment: the identity measures it in the frame of a map that was aligned before.
AbsoluteTrajectoryError absolute_trajectory_error(const std::vector<PosePair>& pairs,
                                                  const Similarity& truth_from_estimate);

// The pose the estimate gives once it is aligned and scaled to the truth.
Pose aligned(const Similarity& truth_from_estimate, const Pose& world_from_body);

struct RelativePoseError {
  ErrorStatistics translation;  // metres
  ErrorStatistics rotation;     // degrees
};

// E = inv(inv(Q_i) Q_j) (inv(P_i) P_j) (Sturm 2012), over pairs of poses one frame, one interval of time, or one
// length of true path apart. The estimate's translations are multiplied by scale first. Every pose starts a pair with
// the one nearest to the interval or length, unless that is more than 10 % off.
RelativePoseError relative_pose_error_by_frame(const std::vector<PosePair>& pairs, double scale);
RelativePoseError relative_pose_error_by_time(const std::vector<PosePair>& pairs, Timestamp interval, double scale);
RelativePoseError relative_pose_error_by_distance(const std::vector<PosePair>& pairs, double metres, double scale);

double path_length(const Trajectory& trajectory);  // metres

// How much of what there was to estimate has a pose: an error alone flatters a trajectory that omits the hard part.
struct Coverage {
  int expected = 0;   // frames that should have a pose
  int with_pose = 0;  // expected frames that have one

  double share() const { return expected > 0 ? static_cast<double>(with_pose) / expected : 0.0; }
};

// Coverage of the given frames: those that have an estimated pose within a millisecond. Precondition: times ascend.
Coverage coverage_of_frames(const Trajectory& estimate, const std::vector<Timestamp>& frame_times);

// Coverage where the frames are not known: as many as fit into the truth's span at the estimate's median interval.
// Takes a trajectory of regularly chosen frames for complete. Empty for fewer than two poses or a truth without a span.
std::optional<Coverage> coverage_of_span(const Trajectory& estimate, const Trajectory& truth, Timestamp time_offset);

}  // namespace byre
