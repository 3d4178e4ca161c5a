#include "byre/motion/unseen_way.h"

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
UnseenWay way(const std::vector<bool>& is_seen, double told_per_true = 1.0, int untold = -1) {
  UnseenWay unseen;
  for (int i = 0; i < static_cast<int>(is_seen.size()); ++i)
    unseen.note(frame(i), is_seen[static_cast<std::size_t>(i)]);
  unseen.take_down([&](Timestamp earlier, Timestamp later) {
    EXPECT_EQ(later - earlier, frame(1));
    return earlier == frame(untold) ? std::nullopt : std::optional(at(told_per_true * kStep));
  });
  return unseen;
}

Pose as_it_is(const Pose& base) {
  return base;
}

TEST(UnseenWay, PropagatesBackToFramesBeforeTheFirstPose) {
  const Trajectory seen = {{frame(3), at(0.3)}, {frame(4), at(0.4)}};
  const Trajectory all = way({false, false, false, true, true}).completed(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(5));
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(all[static_cast<std::size_t>(i)].time, frame(i));
    EXPECT_NEAR(all[static_cast<std::size_t>(i)].world_from_body.translation.x(), kStep * i, 1e-12);
  }
}

TEST(UnseenWay, DistributesTheErrorBetweenTwoPoses) {
  const Trajectory seen = {{frame(0), at(0.0)}, {frame(4), at(0.4)}};
  const Trajectory all = way({true, false, false, false, true}, 1.2).completed(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(5));
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(all[static_cast<std::size_t>(i)].world_from_body.translation.x(), kStep * i, 1e-12) << i;
  }
}

TEST(UnseenWay, ContinuesAfterTheLastPoseInMapUnits) {
  const auto in_map = [](const Pose& base) { return Pose{base.rotation, 0.5 * base.translation}; };
  const Trajectory all = way({true, false, false}).completed({{frame(0), at(1.0)}}, in_map);
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_NEAR(all[2].world_from_body.translation.x(), 1.1, 1e-12);
}

TEST(UnseenWay, OmitsFramesWithoutMeasuredMotion) {
  const Trajectory seen = {{frame(0), at(0.0)}};
  const Trajectory all = way({true, false, false, false}, 1.0, 1).completed(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_EQ(all[1].time, frame(1));
}

TEST(UnseenWay, KeepsExistingPoses) {
  const Trajectory seen = {{frame(0), at(0.0)}, {frame(1), at(0.7)}, {frame(2), at(0.2)}};
  const Trajectory all = way({true, false, true}).completed(seen, as_it_is);
  ASSERT_THAT(all, SizeIs(3));
  EXPECT_NEAR(all[1].world_from_body.translation.x(), 0.7, 1e-12);
}

TEST(UnseenWay, RecomputesUntrackedPosesOnRequest) {
  const Trajectory bridged = {{frame(0), at(0.0)}, {frame(1), at(0.7)}, {frame(2), at(0.2)}, {frame(3), at(0.9)}};
  const Trajectory all = way({true, false, true, false}).completed(bridged, as_it_is, UnseenWay::OldPoses::made_anew);
  ASSERT_THAT(all, SizeIs(4));
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(all[static_cast<std::size_t>(i)].world_from_body.translation.x(), kStep * i, 1e-12) << i;
  }
}

TEST(UnseenWay, ReportsUntrackedIntervals) {
  UnseenWay unseen = way({true, true, true, false, true, true, false, false, true, true});
  const auto expect_seen = [&] {
    EXPECT_TRUE(unseen.is_seen(frame(0), frame(2)));
    EXPECT_FALSE(unseen.is_seen(frame(2), frame(3)));
    EXPECT_FALSE(unseen.is_seen(frame(2), frame(5)));
    EXPECT_TRUE(unseen.is_seen(frame(4), frame(5)));
    EXPECT_FALSE(unseen.is_seen(frame(6), frame(7)));
    EXPECT_TRUE(unseen.is_seen(frame(8), frame(9)));
  };
  expect_seen();
  unseen.note(frame(10), false);
  expect_seen();
  EXPECT_FALSE(unseen.is_seen(frame(9), frame(10))) << "not reported yet";
}

TEST(UnseenWay, ReportsTheFirstUnstoredInterval) {
  UnseenWay unseen;
  unseen.note(frame(0), true);
  unseen.note(frame(1), true);
  EXPECT_FALSE(unseen.first_untold());
  unseen.note(frame(2), false);
  EXPECT_EQ(unseen.first_untold(), frame(1));
  unseen.take_down([](Timestamp, Timestamp) { return std::nullopt; });
  EXPECT_FALSE(unseen.first_untold());
}

}  // namespace
}  // namespace byre
