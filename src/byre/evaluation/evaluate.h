#pragma once

#include "byre/evaluation/segment_error.h"
#include "byre/trajectory_error.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

enum class PoseAlignment { se3, sim3, origin, none };

// How figures were made; without it they cannot be compared with others.
struct EvaluationProtocol {
  std::string label = "not stated";  // kind of the poses, causal or final
  PoseAlignment alignment = PoseAlignment::se3;
  AssociationOptions association;
};

// The frames that should have a pose, and where they come from, as the report says it.
struct ExpectedFrames {
  std::vector<Timestamp> times;
  std::string source;
};

struct EvaluationReport {
  EvaluationProtocol protocol;
  int estimated_poses = 0;
  int true_poses = 0;
  int pairs = 0;
  double true_path = 0.0;                      // metres, between the poses that were compared
  std::optional<Coverage> coverage;            // empty when it cannot be told
  std::string coverage_source;                 // what the expected frames are
  std::optional<AbsoluteTrajectoryError> ate;  // empty when the positions determine no alignment
  RelativePoseError rpe_frame;
  RelativePoseError rpe_second;
  RelativePoseError rpe_metre;
  SegmentErrors segments;  // errors of KITTI's segments; none where the path is shorter than 100 m
  Eigen::Vector3d true_spread = Eigen::Vector3d::Zero();  // see principal_spread
};

// The true path is so near to a line that an alignment is free to turn about it: what lies across the line is not much
// more than the errors, or next to nothing of what lies along it.
bool is_nearly_a_line(const EvaluationReport& report);

// Empty when no estimated pose has truth at its time.
std::optional<EvaluationReport> evaluate(const Trajectory& estimate, const Trajectory& truth,
                                         const EvaluationProtocol& protocol,
                                         const std::optional<ExpectedFrames>& expected);

}  // namespace byre
