#pragma once

#include "byre/benchmark/demo/findings.h"

namespace byre {

inline DemoArm ten_frames(Arm arm) {
  DemoArm result{.arm = arm, .measures = {}, .moments = {}};
  for (int i = 0; i < 10; ++i) {
    result.moments.push_back({.time_s = 0.4 * i,
                              .has_pose = true,
                              .verdict = Verdict::trusted,
                              .offline_inliers = 100,
                              .online_inliers = 10 * i,
                              .position_sigma = 0.004,
                              .truth = {0.3 * i, 0.0},
                              .position = Eigen::Vector2d(0.3 * i, 0.01),
                              .error = 0.01});
  }
  return result;
}

inline DemoFindings small_findings() {
  DemoFindings findings;
  findings.arms = {ten_frames(Arm::no_map), ten_frames(Arm::localise_only), ten_frames(Arm::hybrid)};
  findings.off_the_map = {{1.0, 2.0}};
  findings.mission_picture = {100, 50, {}};
  findings.plan_picture = "<svg xmlns=\"http://www.w3.org/2000/svg\"><title>plan & paths</title></svg>";
  findings.camera_picture = "<svg xmlns=\"http://www.w3.org/2000/svg\"><title>camera</title></svg>";
  findings.camera_s = 1.2;
  return findings;
}

}  // namespace byre
