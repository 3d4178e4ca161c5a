#pragma once

#include "byre/benchmark/measures.h"
#include "byre/benchmark/protocol.h"
#include "byre/slam/health.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// One frame of a demonstrated run.
struct DemoMoment {
  double time_s = 0.0;  // from the first frame
  bool has_pose = false;
  Verdict verdict = Verdict::untrusted;
  int offline_inliers = 0;
  int online_inliers = 0;
  double position_sigma = 0.0;  // metres, see Health
  std::optional<double> error;  // metres, of the position as published on the plan; empty without a pose there
};

// The second visit as one of the arms saw it.
struct DemoArm {
  Arm arm = Arm::hybrid;
  RunMeasures measures;
  double close_share = 0.0;  // share of all frames that published a position within kCloseMetres of the truth
  std::vector<DemoMoment> moments;
};

inline constexpr double kCloseMetres = 0.1;

struct TimeSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

// What a demonstration came to.
struct DemoFindings {
  int map_frames = 0;  // frames of the first visit
  int map_keyframes = 0;
  int map_points = 0;
  double map_ate = 0.0;  // metres RMSE, final poses
  int picks = 0;
  std::vector<DemoArm> arms;
  std::vector<TimeSpan> off_the_map;  // while the robot was where the first visit never was
  std::string plan_picture;           // SVG
  std::string camera_picture;         // SVG
  std::optional<double> camera_s;     // when the latter was taken, from the first frame
  double rendering_s = 0.0;           // wall time
  double total_s = 0.0;
};

}  // namespace byre
