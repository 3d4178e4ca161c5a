#include "byre/playback/frame_source.h"

#include <atomic>
#include <stdexcept>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Recording whose frame 2 is unreadable.
class FakeRecording final : public Recording {
 public:
  explicit FakeRecording(int frames) {
    for (int i = 0; i < frames; ++i) times_.emplace_back(10 * i);
  }

  const Calibration& calibration() const override { return calibration_; }
  const std::vector<Timestamp>& times() const override { return times_; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  std::optional<ImageFrame> read(int index) override {
    ++reads;
    if (index == failing) throw std::runtime_error("the camera is gone");
    if (index == 2) {
      warnings_.push_back("frame 2 is torn");
      return std::nullopt;
    }
    return ImageFrame{times_[static_cast<std::size_t>(index)], {1, 1, {static_cast<std::uint8_t>(index)}}, {}};
  }

  std::atomic<int> reads = 0;
  int failing = -1;

 private:
  Calibration calibration_;
  std::vector<Timestamp> times_;
  std::vector<std::string> warnings_;
};

TEST(DecodeAhead, ReturnsAllFramesInOrder) {
  FakeRecording recording(20);
  DecodeAhead decoder(recording);
  for (int i = 0; i < 20; ++i) {
    const std::optional<DecodedFrame> frame = decoder.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->time, Timestamp(10 * i));
    ASSERT_EQ(frame->images.has_value(), i != 2);
    if (i == 2) continue;
    EXPECT_EQ(frame->images->left.pixels.front(), i);
  }
  EXPECT_FALSE(decoder.next());
  EXPECT_FALSE(decoder.next());
}

TEST(DecodeAhead, ReturnsWarningsWithTheirFrame) {
  FakeRecording recording(4);
  DecodeAhead decoder(recording);
  EXPECT_THAT(decoder.next()->warnings, IsEmpty());
  EXPECT_THAT(decoder.next()->warnings, IsEmpty());
  EXPECT_THAT(decoder.next()->warnings, ElementsAre("frame 2 is torn"));
  EXPECT_THAT(decoder.next()->warnings, IsEmpty());
}

TEST(DecodeAhead, LimitsTheNumberOfFramesAhead) {
  FakeRecording recording(100);
  DecodeAhead decoder(recording);
  for (int taken = 0; taken < 100; ++taken) {
    EXPECT_LE(recording.reads, taken + DecodeAhead::kAhead);
    ASSERT_TRUE(decoder.next());
  }
  EXPECT_EQ(recording.reads, 100);
}

TEST(DecodeAhead, SkipsAFrameWhoseReadingThrows) {
  FakeRecording recording(3);
  recording.failing = 1;
  DecodeAhead decoder(recording);
  EXPECT_TRUE(decoder.next()->images);
  const auto left_out = decoder.next();
  EXPECT_FALSE(left_out->images);
  EXPECT_EQ(left_out->time, Timestamp(10));
  EXPECT_THAT(left_out->warnings, ElementsAre("frame 1 is skipped: the camera is gone"));
  EXPECT_FALSE(decoder.next()->images) << "frame 2 cannot be read";
}

TEST(DecodeAhead, MayBeDestroyedAtAnyFrame) {
  for (int taken = 0; taken < 6; ++taken) {
    FakeRecording recording(6);
    {
      DecodeAhead decoder(recording);
      for (int i = 0; i < taken; ++i) decoder.next();
    }
    EXPECT_LE(recording.reads, taken + DecodeAhead::kAhead);
  }
}

}  // namespace
}  // namespace byre
