#include "byre/camera/frame_sink.h"

#include "byre/input_error.h"
#include "byre/recording.h"
#include "byre/simulation/rendered_room_scene.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::SizeIs;

constexpr Timestamp kStart = std::chrono::seconds(1'800'000'000);
constexpr Timestamp kInterval = std::chrono::milliseconds(50);

class FrameSinks : public testing::Test {
 protected:
  FrameSinks() { fs::remove_all(folder_), fs::create_directories(folder_); }
  ~FrameSinks() override { fs::remove_all(folder_); }

  static Calibration calibration() { return euroc_like_calibration(8); }

  // Images whose values identify camera, frame and pixel.
  static ImageFrame frame(int number) {
    const Camera& camera = calibration().left;
    const auto image = [&](int value) {
      Image made{camera.width, camera.height, {}};
      for (int i = 0; i < camera.width * camera.height; ++i)
        made.pixels.push_back(static_cast<std::uint8_t>(value + i % 100));
      return made;
    };
    return {kStart + number * kInterval, image(number), image(100 + number)};
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_frame_sink." + std::to_string(getpid()));
};

TEST_F(FrameSinks, PreservePixelsStampsAndCalibration) {
  for (const char* const name : {"walk", "walk.mcap"}) {
    const auto sink = open_sink(folder_ / name, {true, 20.0, calibration()});
    for (int i = 0; i < 4; ++i) sink->write(frame(i));
    sink->finish();
    const auto recording = open_recording(folder_ / name, {});
    ASSERT_THAT(recording->times(), SizeIs(4)) << name;
    EXPECT_TRUE(recording->calibration().right);
    EXPECT_NEAR(recording->calibration().left.fx, calibration().left.fx, 1e-9);
    for (int i = 0; i < 4; ++i) {
      const auto read = recording->read(i);
      ASSERT_TRUE(read && read->right);
      EXPECT_EQ(read->time, kStart + i * kInterval);
      EXPECT_EQ(read->left.pixels, frame(i).left.pixels) << name;
      EXPECT_EQ(read->right->pixels, frame(i).right->pixels) << name;
    }
  }
}

TEST_F(FrameSinks, StoreFramesWithoutRightImage) {
  const auto sink = open_sink(folder_ / "walk", {true, 20.0, calibration()});
  sink->write(frame(0));
  ImageFrame alone = frame(1);
  alone.right.reset();
  sink->write(alone);
  sink->write(frame(2));
  const auto recording = open_recording(folder_ / "walk", {});
  ASSERT_THAT(recording->times(), SizeIs(3));
  EXPECT_FALSE(recording->read(1)->right);
  EXPECT_TRUE(recording->read(2)->right);
}

TEST_F(FrameSinks, AreCompleteUpToTheLastFrameAfterAnyEnd) {
  const auto folder = open_sink(folder_ / "walk", {false, 20.0, {}});
  const auto bag = open_sink(folder_ / "walk.mcap", {true, 20.0, calibration()});
  for (int i = 0; i < 45; ++i) {
    folder->write(frame(i));
    bag->write(frame(i));
  }
  // Neither sink is finished, and both are still open.
  std::ifstream list(folder_ / "walk" / "mav0" / "cam0" / "data.csv");
  int lines = 0;
  for (std::string line; std::getline(list, line);) ++lines;
  EXPECT_EQ(lines, 46);
  EXPECT_GE(open_recording(folder_ / "walk.mcap", {})->size(), 40) << "all but the last second";
}

TEST_F(FrameSinks, NeverWriteIntoAnExistingRecording) {
  open_sink(folder_ / "walk", {true, 20.0, {}})->write(frame(0));
  EXPECT_THROW(open_sink(folder_ / "walk", {true, 20.0, {}}), InputError);
  EXPECT_THROW(open_sink(folder_ / "none" / "walk.mcap", {true, 20.0, {}}), InputError);
}

}  // namespace
}  // namespace byre
