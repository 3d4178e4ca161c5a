#pragma once

#include "byre/geometry/evaluation/segment_error.h"
#include "byre/trajectory_error.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

enum class PoseAlignment { se3, sim3, origin, none };

// Protocol of an evaluation, needed to compare its figures with others.
struct EvaluationProtocol {
  std::string label = "not stated";  // kind of poses: causal or final
  PoseAlignment alignment = PoseAlignment::se3;
  AssociationOptions association;
};

// Frames that should have a pose; source: their description in the report.
struct ExpectedFrames {
  std::vector<Timestamp> times;
  std::string source;
};

struct EvaluationReport {
  EvaluationProtocol protocol;
  int estimated_poses = 0;
  int true_poses = 0;
  int pairs = 0;
  double true_path = 0.0;                      // metres, between the compared poses
  std::optional<Coverage> coverage;            // empty if undetermined
  std::string coverage_source;                 // description of the expected frames
  std::optional<AbsoluteTrajectoryError> ate;  // empty if the positions determine no alignment
  RelativePoseError rpe_frame;
  RelativePoseError rpe_second;
  RelativePoseError rpe_metre;
  SegmentErrors segments;                                 // KITTI segments; none for paths shorter than 100 m
  Eigen::Vector3d true_spread = Eigen::Vector3d::Zero();  // see principal_spread
};

// Whether the true path is so nearly a line that the rotation about it is undetermined: its width is below a few
// position errors or a small share of its length.
bool is_nearly_straight(const EvaluationReport& report);

// Empty if no estimated pose has truth at its time.
std::optional<EvaluationReport> evaluate(const Trajectory& estimate, const Trajectory& truth,
                                         const EvaluationProtocol& protocol,
                                         const std::optional<ExpectedFrames>& expected);

}  // namespace byre
