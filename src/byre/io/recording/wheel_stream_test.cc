#include "byre/io/recording/motion_files.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

using Kind = WheelStream::Kind;

// A driver at 20 Hz: the base stands for a second, then drives at 0.5 m/s.
WheelSample sample_at(int step, bool has_pose, bool has_velocity) {
  const double seconds = 0.05 * step, way = 0.5 * std::max(0.0, seconds - 1.0);
  WheelSample sample{from_seconds(seconds), {}, {}};
  sample.pose = Pose{Eigen::Quaterniond::Identity(), {has_pose ? way : 0.0, 0.0, 0.0}};
  sample.velocity = BaseTwist{sample.time, has_velocity && seconds > 1.0 ? 0.5 : 0.0, 0.0, 0.0};
  return sample;
}

struct Counted {
  int poses = 0;
  int velocities = 0;
  Kind kind = Kind::open;
};

Counted count_samples(bool has_pose, bool has_velocity, int steps = 60) {
  WheelStream stream;
  Counted counted;
  Timestamp last{-1};
  for (int i = 0; i < steps; ++i) {
    stream.add(sample_at(i, has_pose, has_velocity));
    for (const WheelSample& sample : stream.take()) {
      EXPECT_GT(sample.time, last);
      last = sample.time;
      ++(sample.pose ? counted.poses : counted.velocities);
    }
  }
  counted.kind = stream.kind();
  return counted;
}

TEST(WheelStream, SelectsPosesIfPresent) {
  const Counted both = count_samples(true, true);
  EXPECT_EQ(both.kind, Kind::poses);
  EXPECT_EQ(both.poses, 60);
  EXPECT_EQ(both.velocities, 0);
  EXPECT_EQ(count_samples(true, false).poses, 60) << "a driver that measures poses only";
}

TEST(WheelStream, SelectsVelocitiesIfPosesNeverChange) {
  const Counted counted = count_samples(false, true);
  EXPECT_EQ(counted.kind, Kind::velocities);
  EXPECT_EQ(counted.poses, 21) << "all samples of the second at rest";
  EXPECT_EQ(counted.velocities, 39) << "all later samples, with the delayed ones";
}

TEST(WheelStream, StaysUndecidedAtRest) {
  EXPECT_EQ(count_samples(false, true, 15).kind, Kind::open);
  EXPECT_EQ(count_samples(false, true, 15).poses, 15);
  WheelStream stream;
  for (int i = 0; i < 2000; ++i) {
    WheelSample sample = sample_at(0, false, false);
    sample.time = from_seconds(0.05 * i);
    sample.velocity = BaseTwist{sample.time, i % 2 == 0 ? 0.01 : -0.01, 0.0, i % 2 == 0 ? -0.01 : 0.01};
    stream.add(sample);
  }
  EXPECT_NE(stream.kind(), Kind::velocities) << "noise is no motion";
}

TEST(WheelStream, SwitchesToPosesThatStartToChange) {
  WheelStream stream;
  for (int i = 0; i < 40; ++i) stream.add(sample_at(i, false, true));
  ASSERT_EQ(stream.kind(), Kind::velocities);
  stream.add(sample_at(41, true, true));
  EXPECT_EQ(stream.kind(), Kind::poses);
}

TEST(WheelStream, DelaysNoVelocitiesWithoutPoses) {
  WheelStream stream;
  WheelSample sample = sample_at(0, false, true);
  sample.pose.reset();
  stream.add(sample);
  EXPECT_EQ(stream.take().size(), 1u);
}

}  // namespace
}  // namespace byre
