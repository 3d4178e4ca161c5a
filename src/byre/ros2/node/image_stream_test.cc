// Image stream: pairing, and faults of cameras.

#include "byre/ros2/node/camera_monitor.h"
#include "byre/ros2/node/image_pairs.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

using Pairs = ImagePairs<int>;

// Pairs that are queued but not taken.
Pairs waiting_pairs(int count) {
  Pairs pairs({true, 0ms, 50ms});
  for (int i = 1; i <= count; ++i) {
    pairs.add_left(Timestamp(i * 1s), i, 0ms);
    pairs.add_second(Timestamp(i * 1s), 10 + i, 0ms);
  }
  return pairs;
}

TEST(ImagePairs, ReturnsTheNewestCompletePairAndSkipsOlderOnes) {
  Pairs pairs = waiting_pairs(3);
  pairs.add_left(4s, 4, 2ms);
  const auto pair = pairs.next(3ms);
  ASSERT_TRUE(pair.has_value());
  EXPECT_EQ(pair->left, 3);
  EXPECT_EQ(pair->second, 13);
  EXPECT_EQ(pairs.counts().skipped, 2);
  EXPECT_FALSE(pairs.next(4ms)) << "the fourth waits for its right image";
  pairs.add_second(4s, 14, 5ms);
  EXPECT_EQ(pairs.next(5ms)->second, 14);
}

TEST(ImagePairs, SkipsNoneIfReadOneLate) {
  Pairs pairs = waiting_pairs(2);
  EXPECT_EQ(pairs.next(1ms)->left, 1);
  EXPECT_EQ(pairs.next(2ms)->left, 2);
  EXPECT_EQ(pairs.counts().skipped, 0);
}

TEST(ImagePairs, ReturnsALeftImageAloneAfterTheTimeout) {
  Pairs pairs({true, 0ms, 50ms});
  pairs.add_left(1s, 1, 0ms);
  pairs.add_second(1s + 1ms, 11, 0ms);
  EXPECT_FALSE(pairs.next(49ms));
  const auto pair = pairs.next(50ms);
  ASSERT_TRUE(pair.has_value());
  EXPECT_FALSE(pair->second.has_value());
  EXPECT_EQ(pair->nearest, Timestamp(1ms));
  EXPECT_EQ(pairs.counts().without_second, 1);
}

// Such as depth at half the rate of colour.
TEST(ImagePairs, ReturnsALeftImageAloneBeforeANewerPair) {
  Pairs pairs({true, 5ms, 50ms});
  for (int i = 1; i <= 8; ++i) {
    const Timestamp time = i * 33ms;
    pairs.add_left(time, i, time);
    if (i % 2 == 1) {
      EXPECT_FALSE(pairs.next(time)) << i;
      continue;
    }
    pairs.add_second(time, 10 + i, time);
    const auto alone = pairs.next(time);
    ASSERT_TRUE(alone.has_value());
    EXPECT_EQ(alone->left, i - 1);
    EXPECT_EQ(alone->second, std::nullopt);
    EXPECT_EQ(alone->nearest, Timestamp(33ms));
    EXPECT_EQ(pairs.next(time)->second, 10 + i);
    EXPECT_FALSE(pairs.next(time));
  }
  EXPECT_EQ(pairs.counts().skipped, 0);
  EXPECT_EQ(pairs.counts().without_second, 4);
}

TEST(ImagePairs, MatchesTheNearestRightImageWithinTheTolerance) {
  Pairs pairs({true, 5ms, 50ms});
  pairs.add_second(1s - 4ms, 10, 0ms);
  pairs.add_second(1s + 2ms, 11, 0ms);
  pairs.add_left(1s, 1, 0ms);
  EXPECT_EQ(pairs.next(0ms)->second, 11);
}

TEST(ImagePairs, ReturnsLeftImagesForOneCamera) {
  Pairs pairs({false, 0ms, 50ms});
  pairs.add_left(1s, 1, 0ms);
  pairs.add_left(2s, 2, 0ms);
  EXPECT_EQ(pairs.next(0ms)->left, 1);
  EXPECT_EQ(pairs.next(0ms)->left, 2);
  EXPECT_FALSE(pairs.next(0ms));
}

TEST(ImagePairs, LimitsStoredImages) {
  Pairs pairs({true, 0ms, 1s});
  for (int i = 0; i < 100; ++i) pairs.add_left(Timestamp(i * 50ms), i, 0ms);
  EXPECT_EQ(pairs.counts().skipped, 92);
}

class CameraWatchTest : public testing::Test {
 protected:
  void frames(Timestamp from, int count, const CameraFrame& frame) {
    for (int i = 0; i < count; ++i) {
      monitor_.note_arrival(from + i * 50ms);
      monitor_.note_frame(frame, from + i * 50ms);
    }
  }
  std::string message(Timestamp now) const { return monitor_.status(now).message; }
  std::byte level(Timestamp now) const { return monitor_.status(now).level; }

  CameraMonitor monitor_{"/left", "right", 0s};
  CameraFrame good_;
  CameraFrame left_alone_ = [] {
    CameraFrame frame;
    frame.has_second = false;
    return frame;
  }();
};

TEST_F(CameraWatchTest, ReportsNothingForAWorkingCamera) {
  frames(1s, 40, good_);
  EXPECT_EQ(level(3s), ros::DiagnosticStatus::kOk);
}

TEST_F(CameraWatchTest, ReportsASilentCamera) {
  EXPECT_EQ(level(1500ms), ros::DiagnosticStatus::kStale);
  EXPECT_THAT(message(1500ms), HasSubstr("no images on /left"));
  frames(2s, 20, good_);
  EXPECT_EQ(level(3s), ros::DiagnosticStatus::kOk);
  EXPECT_EQ(level(3600ms), ros::DiagnosticStatus::kStale) << "within a second";
  EXPECT_THAT(message(3600ms), HasSubstr("no image for"));
}

TEST_F(CameraWatchTest, ReportsLostRightImages) {
  frames(1s, 20, good_);
  frames(2s, 4, left_alone_);
  EXPECT_EQ(level(2200ms), ros::DiagnosticStatus::kWarn);
  frames(2200ms, 20, left_alone_);
  EXPECT_EQ(level(3200ms), ros::DiagnosticStatus::kError);
  EXPECT_THAT(message(3200ms), HasSubstr("right images are missing"));
  left_alone_.nearest_second = 3ms;
  frames(3200ms, 1, left_alone_);
  EXPECT_THAT(message(3200ms), HasSubstr("the nearest time stamp differs by 3.0 ms, see images.pair_tolerance"));
  frames(3200ms, 25, good_);
  EXPECT_EQ(level(4450ms), ros::DiagnosticStatus::kOk);
}

TEST_F(CameraWatchTest, NamesTheSecondImagesByTheirKind) {
  CameraMonitor monitor("/left", "depth", 0s);
  monitor.note_arrival(1s);
  monitor.note_frame(left_alone_, 1s);
  EXPECT_THAT(monitor.status(1s).message, HasSubstr("depth images are missing: 1 of the last 1"));
}

TEST_F(CameraWatchTest, ReportsFrozenImagesJumpsAndUnusableImages) {
  CameraFrame frame = good_;
  frame.is_frozen = true;
  frames(1s, 1, frame);
  EXPECT_THAT(message(1s), HasSubstr("repeated image"));
  frame = good_;
  frame.jump = -3600s;
  frames(3s, 1, frame);
  EXPECT_THAT(message(3s), HasSubstr("stamps jumped by -3600.000 s"));
  frames(3500ms, 10, good_);
  monitor_.note_unusable(InputError("/left", "is odd", "mend it"), 4s);
  EXPECT_THAT(message(4s), HasSubstr("/left: is odd (mend it); time stamps jumped")) << "all findings";
  EXPECT_EQ(level(4s), ros::DiagnosticStatus::kError);
}

TEST_F(CameraWatchTest, CountsReplacedImages) {
  frames(1s, 20, good_);
  monitor_.note_skipped(3, 1950ms);
  EXPECT_EQ(level(2s), ros::DiagnosticStatus::kWarn);
  EXPECT_THAT(message(2s), HasSubstr("3 images of the last second"));
}

}  // namespace
}  // namespace byre
