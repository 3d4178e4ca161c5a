#include "byre/odometry/time_offset.h"

#include <algorithm>
#include <deque>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Yaw of a robot that stands, turns with a turn rate that grows for a second, and stops at once.
double yaw_at(double seconds) {
  const double turning = std::clamp(seconds - 2.0, 0.0, 6.0);
  return turning < 1.0 ? 0.2 * turning * turning : 0.4 * turning - 0.2;
}

Pose turned(double yaw) {
  return {rotation_exp({0.0, 0.0, yaw}), Eigen::Vector3d::Zero()};
}

// A focal length 14 % too long shortens all turns in images.
TEST(TimeOffset, DoesNotDependOnTheFocalLength) {
  for (const double delay : {-0.07, 0.0, 0.07}) {
    for (const double scale : {1.0, 0.86}) {
      WheelTrack wheels;
      for (int i = 0; i < 250; ++i) wheels.add({from_seconds(0.04 * i + delay), turned(yaw_at(0.04 * i))});
      std::deque<VisualMotion> seen;
      for (double t = 0.5; t < 9.0; t += 0.5) {
        seen.push_back({from_seconds(t), from_seconds(t + 0.5), turned(scale * (yaw_at(t + 0.5) - yaw_at(t)))});
      }
      const auto found = find_time_offset(seen, Eigen::Vector3d::UnitZ(), wheels);
      ASSERT_TRUE(found) << delay << " " << scale;
      EXPECT_NEAR(*found, delay, 0.01) << scale;
    }
  }
}

}  // namespace
}  // namespace byre
