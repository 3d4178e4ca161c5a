#pragma once

#include "byre/benchmark/measures.h"
#include "byre/benchmark/protocol.h"
#include "byre/slam/frame/health.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

struct DemoMoment {
  double time_s = 0.0;  // from the first frame
  bool has_pose = false;
  Verdict verdict = Verdict::untrusted;
  int offline_inliers = 0;
  int online_inliers = 0;
  double position_sigma = 0.0;  // metres, see Health
  std::optional<double> error;  // metres, of the published position on the plan; empty without a pose
};

// Run of the second visit by one arm.
struct DemoArm {
  Arm arm = Arm::hybrid;
  RunMeasures measures;
  double close_share = 0.0;  // share of all frames with a published position within kCloseMetres of the truth
  std::vector<DemoMoment> moments;
};

inline constexpr double kCloseMetres = 0.1;

struct TimeSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

struct DemoFindings {
  int map_frames = 0;  // frames of the first visit
  int map_keyframes = 0;
  int map_points = 0;
  double map_ate = 0.0;  // metres RMSE, final poses
  int picks = 0;
  std::vector<DemoArm> arms;
  std::vector<TimeSpan> off_the_map;  // spans in which the robot was outside the first visit's area
  std::string plan_picture;           // SVG
  std::string camera_picture;         // SVG
  std::optional<double> camera_s;     // time of the camera picture, from the first frame
  double rendering_s = 0.0;           // wall time
  double total_s = 0.0;
};

}  // namespace byre
