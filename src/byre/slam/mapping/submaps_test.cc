#include "byre/slam/mapping/submaps.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

KeyframeId online(std::uint32_t number) {
  return {Origin::online, number};
}

// A submap with keyframes 0 to 3 and one from 4 on.
Submaps two_in_map_frame() {
  Submaps submaps;
  submaps.begin_in_map_frame(0);
  submaps.begin_in_map_frame(4);
  return submaps;
}

TEST(Submaps, StartingInTheMapFrameShareIt) {
  const Submaps submaps = two_in_map_frame();
  EXPECT_EQ(submaps.frame(online(3)), Submaps::kMapFrame);
  EXPECT_EQ(submaps.frame(online(4)), Submaps::kMapFrame);
}

TEST(Submaps, AreSeparateUntilTheyJoinTheMapFrame) {
  Submaps submaps = two_in_map_frame();
  EXPECT_FALSE(submaps.has_separate());
  submaps.begin_in_own_frame(8);
  EXPECT_TRUE(submaps.has_separate());
  submaps.join_map_frame(submaps.frame());
  EXPECT_FALSE(submaps.has_separate());
}

TEST(Submaps, StartingInTheirOwnFrameAreSeparate) {
  Submaps submaps;
  submaps.begin_in_own_frame(0);
  submaps.begin_in_own_frame(4);
  EXPECT_NE(submaps.frame(online(3)), submaps.frame(online(4)));
  EXPECT_EQ(submaps.frame(online(9)), submaps.frame());
}

TEST(Submaps, JoinTheMapFrameWithAllSubmapsOfTheirFrame) {
  Submaps submaps;
  submaps.begin_in_own_frame(0);
  submaps.begin_in_own_frame(4);
  submaps.begin_in_frame_of(online(2), 7);
  submaps.join_map_frame(submaps.frame());
  EXPECT_EQ(submaps.frame(online(2)), Submaps::kMapFrame);
  EXPECT_NE(submaps.frame(online(5)), Submaps::kMapFrame);
  EXPECT_EQ(submaps.frame(online(8)), Submaps::kMapFrame);
}

TEST(Submaps, LeaveTheMapFrameSeparately) {
  Submaps submaps = two_in_map_frame();
  submaps.leave_map_frame(0);
  EXPECT_EQ(submaps.size(), 2u);
  EXPECT_EQ(submaps.frame(online(3)), Submaps::kMapFrame);
  EXPECT_NE(submaps.frame(online(4)), Submaps::kMapFrame);
}

TEST(Submaps, LeaveTheMapFrameFromAKeyframeOn) {
  Submaps submaps = two_in_map_frame();
  submaps.leave_map_frame(7);
  EXPECT_EQ(submaps.size(), 3u);
  EXPECT_EQ(submaps.frame(online(6)), Submaps::kMapFrame);
  EXPECT_NE(submaps.frame(online(7)), Submaps::kMapFrame);
  EXPECT_FALSE(submaps.is_registered());
}

TEST(Submaps, WithoutKeyframeAreRemoved) {
  Submaps submaps;
  submaps.begin_in_own_frame(4);
  submaps.begin_in_map_frame(4);
  EXPECT_EQ(submaps.frame(online(4)), Submaps::kMapFrame);
}

}  // namespace
}  // namespace byre
