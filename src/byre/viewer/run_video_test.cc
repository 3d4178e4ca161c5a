#include "byre/viewer/run_video.h"

#include "byre/input_error.h"
#include "byre/viewer/picture_matchers.h"

#include <gmock/gmock.h>
#include <opencv2/videoio.hpp>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

class RunVideoTest : public testing::Test {
 protected:
  ~RunVideoTest() override { fs::remove(file_); }

  fs::path file_ = fs::path(testing::TempDir()) / ("byre_run_video." + std::to_string(getpid()) + ".mp4");
};

Picture plain(const Colour& colour, int width, int height) {
  return {width, height, {{0, 0, width, height, colour, {}}}};
}

TEST_F(RunVideoTest, ContainsEveryFrameAtItsRate) {
  {
    RunVideo video(file_, 12.5, 161, 120);
    for (int i = 0; i < 7; ++i) video.add(plain({0, 0, 200}, 161, 120));
    for (int i = 0; i < 6; ++i) video.add(plain({200, 0, 0}, 161, 120));
    EXPECT_FALSE(fs::exists(file_)) << "incomplete";
    video.finish();
  }
  cv::VideoCapture played(file_.string());
  ASSERT_TRUE(played.isOpened());
  EXPECT_NEAR(played.get(cv::CAP_PROP_FPS), 12.5, 0.01);
  std::vector<cv::Mat> frames;
  for (cv::Mat frame; played.read(frame);) frames.push_back(frame.clone());
  ASSERT_EQ(frames.size(), 13u);
  EXPECT_EQ(frames[0].size(), cv::Size(162, 120)) << "even, as required by the format";
  EXPECT_GT(colour_at(frames[2], 80, 60).blue, 150);
  EXPECT_GT(colour_at(frames[10], 80, 60).red, 150);
}

TEST_F(RunVideoTest, CropsAndPadsFramesOfOtherSizes) {
  {
    RunVideo video(file_, 10.0, 160, 120);
    for (int i = 0; i < 3; ++i) video.add(plain({0, 0, 200}, 80, 300));
    video.finish();
  }
  cv::VideoCapture played(file_.string());
  cv::Mat frame;
  ASSERT_TRUE(played.read(frame));
  EXPECT_GT(colour_at(frame, 40, 110).blue, 150);
  EXPECT_GT(colour_at(frame, 120, 60).red, 230) << "white";
}

TEST_F(RunVideoTest, ReportsAnUnwritableFile) {
  EXPECT_THROW(RunVideo("/nowhere/at/all.mp4", 10.0, 160, 120), InputError);
}

FrameScene grey_frame() {
  FrameScene scene;
  scene.left = {640, 480, std::vector<std::uint8_t>(640 * 480, 90)};
  return scene;
}

Picture arranged(double width, double height) {
  PlanPictureOptions options;
  options.shown = Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), Eigen::Vector2d(width, height));
  return frame_and_plan(grey_frame(), {}, {}, options);
}

TEST(FrameAndPlan, PlacesAWideBuildingBelowTheCamera) {
  const Picture camera = camera_picture(grey_frame());
  const Picture picture = arranged(60.0, 20.0);
  EXPECT_EQ(picture.width, camera.width);
  EXPECT_GT(picture.height, camera.height + camera.width / 4);
}

TEST(FrameAndPlan, PlacesATallBuildingNextToTheCamera) {
  const Picture camera = camera_picture(grey_frame());
  const Picture picture = arranged(20.0, 20.0);
  EXPECT_GT(picture.width, camera.width);
  EXPECT_LT(picture.height, camera.height + 80);
}

TEST(FrameAndPlan, HasOneSizeForAllFramesOfARun) {
  PlanPictureOptions options;
  options.shown = Eigen::AlignedBox2d(Eigen::Vector2d::Zero(), Eigen::Vector2d(60.0, 20.0));
  PlanScene later;
  later.map.points = {{{5.0f, 5.0f, 0.0f}, Origin::online}};
  later.paths = {{"", {{Timestamp(1), {}}, {Timestamp(2), {}}}, {Verdict::trusted, Verdict::untrusted}}};
  later.camera = PlanCamera{};
  const Picture first = frame_and_plan(grey_frame(), {}, {}, options);
  const Picture last = frame_and_plan(grey_frame(), {}, later, options);
  EXPECT_EQ(first.width, last.width);
  EXPECT_EQ(first.height, last.height);
}

}  // namespace
}  // namespace byre
