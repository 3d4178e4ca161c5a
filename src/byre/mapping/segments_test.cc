#include "byre/mapping/segments.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

KeyframeId online(std::uint32_t number) {
  return {Origin::online, number};
}

// One of keyframes 0 to 3, another of those from 4 on.
Segments two_in_map_frame() {
  Segments segments;
  segments.begin_in_map_frame(0);
  segments.begin_in_map_frame(4);
  return segments;
}

TEST(Segments, ThatBeginInTheMapFrameShareIt) {
  const Segments segments = two_in_map_frame();
  EXPECT_EQ(segments.frame(online(3)), Segments::kMapFrame);
  EXPECT_EQ(segments.frame(online(4)), Segments::kMapFrame);
}

TEST(Segments, OfTheirOwnHaveAFrameEach) {
  Segments segments;
  segments.begin_in_own_frame(0);
  segments.begin_in_own_frame(4);
  EXPECT_NE(segments.frame(online(3)), segments.frame(online(4)));
  EXPECT_EQ(segments.frame(online(9)), segments.frame());
}

TEST(Segments, JoinTheMapFrameTogetherWithAllThatSharesTheirs) {
  Segments segments;
  segments.begin_in_own_frame(0);
  segments.begin_in_own_frame(4);
  segments.begin_beside(online(2), 7);
  segments.join_map_frame(segments.frame());
  EXPECT_EQ(segments.frame(online(2)), Segments::kMapFrame);
  EXPECT_NE(segments.frame(online(5)), Segments::kMapFrame);
  EXPECT_EQ(segments.frame(online(8)), Segments::kMapFrame);
}

TEST(Segments, OfWhichThePresentOneLeavesTheMapFrameAlone) {
  Segments segments = two_in_map_frame();
  segments.leave_map_frame();
  EXPECT_EQ(segments.frame(online(3)), Segments::kMapFrame);
  EXPECT_NE(segments.frame(online(4)), Segments::kMapFrame);
}

TEST(Segments, ThatNeverGotAKeyframeHaveNone) {
  Segments segments;
  segments.begin_in_own_frame(4);
  segments.begin_in_map_frame(4);
  EXPECT_EQ(segments.frame(online(4)), Segments::kMapFrame);
}

}  // namespace
}  // namespace byre
