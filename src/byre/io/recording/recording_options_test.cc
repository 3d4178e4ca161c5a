#include "byre/io/recording/frame_selection.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(ParseFrames, ReadsFirstAndEnd) {
  const std::optional<FrameRange> range = parse_frames("20:150");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 20);
  EXPECT_EQ(range->last, 150);
}

TEST(ParseFrames, AcceptsOpenEnds) {
  ASSERT_TRUE(parse_frames("20:"));
  EXPECT_EQ(parse_frames("20:")->first, 20);
  EXPECT_FALSE(parse_frames("20:")->last);
  ASSERT_TRUE(parse_frames(":150"));
  EXPECT_EQ(parse_frames(":150")->first, 0);
  EXPECT_EQ(parse_frames(":150")->last, 150);
  ASSERT_TRUE(parse_frames(":"));
  EXPECT_FALSE(parse_frames(":")->last);
}

TEST(ParseFrames, RejectsInvalidAndEmptyRanges) {
  for (const char* const text :
       {"", "20", "20-150", "a:b", "-1:5", "0:-5", "0:1.5", "0 :5", "0:5:2", "5:5", "6:5", "0:0", "0:99999999999"}) {
    EXPECT_FALSE(parse_frames(text)) << text;
  }
}

TEST(ParseCamera, ReadsEachName) {
  EXPECT_EQ(parse_camera("stereo"), CameraChoice::stereo);
  EXPECT_EQ(parse_camera("left"), CameraChoice::left);
  EXPECT_EQ(parse_camera("right"), CameraChoice::right);
  EXPECT_EQ(parse_camera("rgbd"), CameraChoice::rgbd);
  EXPECT_FALSE(parse_camera("Left"));
  EXPECT_FALSE(parse_camera(""));
}

}  // namespace
}  // namespace byre
