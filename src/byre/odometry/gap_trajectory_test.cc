#include "byre/odometry/gap_trajectory.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::SizeIs;

constexpr double kStep = 0.1;  // metres that the base drives between frames

Timestamp frame(int number) {
  return from_seconds(0.1 * number);
}

Pose at(double x) {
  return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}};
}

// Frames 0 to 10. Wheels measure the motion of the base times a factor.
GapTrajectory way(const std::vector<bool>& is_seen, double told_per_true = 1.0, int pending = -1) {
  GapTrajectory gaps;
  for (int i = 0; i < static_cast<int>(is_seen.size()); ++i) gaps.note(frame(i), is_seen[static_cast<std::size_t>(i)]);
  gaps.integrate([&](Timestamp earlier, Timestamp later) {
    EXPECT_EQ(later - earlier, frame(1));
    return earlier == frame(pending) ? std::nullopt : std::optional(at(told_per_true * kStep));
  });
  return gaps;
}

Pose as_it_is(const Pose& base) {
  return base;
}

TEST(GapTrajectory, PropagatesBackToFramesBeforeTheFirstPose) {
  const Trajectory seen = {{frame(3), at(0.3)}, {frame(4), at(0.4)}};
  const Trajectory all = way({false, false, false, true, true}).fill_gaps(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(5));
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(all[static_cast<std::size_t>(i)].time, frame(i));
    EXPECT_NEAR(all[static_cast<std::size_t>(i)].world_from_body.translation.x(), kStep * i, 1e-12);
  }
}

TEST(GapTrajectory, DistributesTheErrorBetweenTwoPoses) {
  const Trajectory seen = {{frame(0), at(0.0)}, {frame(4), at(0.4)}};
  const Trajectory all = way({true, false, false, false, true}, 1.2).fill_gaps(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(5));
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(all[static_cast<std::size_t>(i)].world_from_body.translation.x(), kStep * i, 1e-12) << i;
  }
}

TEST(GapTrajectory, KeepsPosesOfFramesLocatedLater) {
  GapTrajectory gaps = way({false, false, false, true, true}, 1.2);
  EXPECT_FALSE(gaps.is_seen(frame(0), frame(1)));
  gaps.note_located({frame(0), frame(1)});
  EXPECT_TRUE(gaps.is_seen(frame(0), frame(1)));
  EXPECT_FALSE(gaps.is_seen(frame(1), frame(3)));
  const Trajectory seen = {{frame(0), at(0.0)}, {frame(1), at(0.1)}, {frame(3), at(0.3)}, {frame(4), at(0.4)}};
  const Trajectory all = gaps.fill_gaps(seen, as_it_is, GapTrajectory::OldPoses::recomputed);
  ASSERT_THAT(all, SizeIs(5));
  EXPECT_EQ(all[1].world_from_body.translation.x(), 0.1);
  EXPECT_NEAR(all[2].world_from_body.translation.x(), 0.2, 1e-12);
}

TEST(GapTrajectory, ContinuesAfterTheLastPoseInMapUnits) {
  const auto in_map = [](const Pose& base) { return Pose{base.rotation, 0.5 * base.translation}; };
  const Trajectory all = way({true, false, false}).fill_gaps({{frame(0), at(1.0)}}, in_map);
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_NEAR(all[2].world_from_body.translation.x(), 1.1, 1e-12);
}

TEST(GapTrajectory, OmitsFramesWithoutMeasuredMotion) {
  const Trajectory seen = {{frame(0), at(0.0)}};
  const Trajectory all = way({true, false, false, false}, 1.0, 1).fill_gaps(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_EQ(all[1].time, frame(1));
}

TEST(GapTrajectory, KeepsExistingPoses) {
  const Trajectory seen = {{frame(0), at(0.0)}, {frame(1), at(0.7)}, {frame(2), at(0.2)}};
  const Trajectory all = way({true, false, true}).fill_gaps(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_NEAR(all[1].world_from_body.translation.x(), 0.7, 1e-12);
}

TEST(GapTrajectory, RecomputesUntrackedPosesOnRequest) {
  const Trajectory bridged = {{frame(0), at(0.0)}, {frame(1), at(0.7)}, {frame(2), at(0.2)}, {frame(3), at(0.9)}};
  const Trajectory all =
      way({true, false, true, false}).fill_gaps(bridged, as_it_is, GapTrajectory::OldPoses::recomputed);
  ASSERT_THAT(all, SizeIs(4));
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(all[static_cast<std::size_t>(i)].world_from_body.translation.x(), kStep * i, 1e-12) << i;
  }
}

TEST(GapTrajectory, ReportsUntrackedIntervals) {
  GapTrajectory gaps = way({true, true, true, false, true, true, false, false, true, true});
  const auto expect_seen = [&] {
    EXPECT_TRUE(gaps.is_seen(frame(0), frame(2)));
    EXPECT_FALSE(gaps.is_seen(frame(2), frame(3)));
    EXPECT_FALSE(gaps.is_seen(frame(2), frame(5)));
    EXPECT_TRUE(gaps.is_seen(frame(4), frame(5)));
    EXPECT_FALSE(gaps.is_seen(frame(6), frame(7)));
    EXPECT_TRUE(gaps.is_seen(frame(8), frame(9)));
  };
  expect_seen();
  gaps.note(frame(10), false);
  expect_seen();
  EXPECT_FALSE(gaps.is_seen(frame(9), frame(10))) << "not reported yet";
}

TEST(GapTrajectory, ReportsTheFirstUnstoredInterval) {
  GapTrajectory gaps;
  gaps.note(frame(0), true);
  gaps.note(frame(1), true);
  EXPECT_FALSE(gaps.first_pending());
  gaps.note(frame(2), false);
  EXPECT_EQ(gaps.first_pending(), frame(1));
  gaps.integrate([](Timestamp, Timestamp) { return std::nullopt; });
  EXPECT_FALSE(gaps.first_pending());
}

}  // namespace
}  // namespace byre
