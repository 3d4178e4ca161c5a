#include "byre/viewer/camera_picture.h"

#include "byre/viewer/palette.h"
#include "byre/viewer/picture_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr Colour kGrey{90, 90, 90};

// Grey image with one point of each kind, far apart.
FrameScene four_points(int width = 752, int height = 480) {
  FrameScene scene;
  scene.left = {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), kGrey.red)};
  scene.seen = {{{Origin::offline, 1}, {100.0f, 50.0f}, true},
                {{Origin::online, 1}, {200.0f, 50.0f}, true},
                {{Origin::offline, 2}, {100.0f, 100.0f}, false},
                {{Origin::online, 2}, {200.0f, 100.0f}, false}};
  scene.report.state = State::tracking;
  scene.report.health.verdict = Verdict::degraded;
  scene.report.health.doubt = DistrustReason::clustered;
  scene.report.health.offline_inliers = 118;
  scene.report.health.offline_expected = 240;
  scene.report.health.online_inliers = 57;
  return scene;
}

TEST(CameraPicture, FillsInliersWithTheColourOfTheirMap) {
  const cv::Mat drawn = decoded(to_png(camera_picture(four_points())));
  EXPECT_EQ(colour_at(drawn, 100, 50), palette::kOffline);
  EXPECT_EQ(colour_at(drawn, 200, 50), palette::kOnline);
  EXPECT_EQ(colour_at(drawn, 102, 50), palette::kOffline) << "filled, not a ring";
  EXPECT_EQ(colour_at(drawn, 150, 50), kGrey);
}

TEST(CameraPicture, IsOfTheRequestedWidth) {
  const Picture half = camera_picture(four_points(), {.title = {}, .panel = false, .width = 376});
  EXPECT_EQ(half.width, 376);
  EXPECT_EQ(half.height, 240);
  EXPECT_EQ(colour_at(decoded(to_png(half)), 50, 25), palette::kOffline);
}

TEST(CameraPicture, DrawsOutliersAsCrosses) {
  const cv::Mat drawn = decoded(to_png(camera_picture(four_points())));
  EXPECT_EQ(colour_at(drawn, 102, 102), palette::kOffline);
  EXPECT_EQ(colour_at(drawn, 98, 102), palette::kOffline);
  EXPECT_EQ(colour_at(drawn, 105, 100), kGrey) << "no disc";
  EXPECT_EQ(colour_at(drawn, 203, 100), palette::kOnline);
  EXPECT_EQ(colour_at(drawn, 200, 97), palette::kOnline);
}

TEST(CameraPicture, LeavesOtherPixelsUnchanged) {
  FrameScene scene = four_points();
  scene.seen.clear();
  for (std::size_t i = 0; i < scene.left.pixels.size(); ++i) scene.left.pixels[i] = static_cast<std::uint8_t>(i * 31);
  const cv::Mat drawn = decoded(to_png(camera_picture(scene)));
  for (const int y : {0, 100, 479}) {
    for (int x = 0; x < 752; ++x) {
      ASSERT_EQ(colour_at(drawn, x, y).red, scene.left.pixels[static_cast<std::size_t>(y * 752 + x)]);
    }
  }
}

TEST(CameraPicture, EnlargesSmallImagesAndReducesLargeOnes) {
  const cv::Mat small = decoded(to_png(camera_picture(four_points(320, 240), {"", false, {}})));
  EXPECT_EQ(small.size(), cv::Size(640, 480));
  EXPECT_EQ(colour_at(small, 201, 101), palette::kOffline);
  const cv::Mat large = decoded(to_png(camera_picture(four_points(2560, 1440), {"", false, {}})));
  EXPECT_EQ(large.size(), cv::Size(1280, 720));
  EXPECT_EQ(colour_at(large, 50, 25), palette::kOffline);
}

TEST(CameraPicture, ShowsHealthNextToTheImage) {
  const Picture picture = camera_picture(four_points(), {"12.50 s", true, {}});
  const std::string svg = to_svg(picture);
  for (const char* const text : {">12.50 s<", ">tracking<", ">degraded<", ">points are clustered<", ">118 of 240<",
                                 ">57<", ">offline outlier<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_GT(picture.width, 752);
  EXPECT_THAT(to_svg(camera_picture(four_points(), {"", false, {}})), Not(HasSubstr("degraded")));
}

TEST(CameraPicture, ShowsTheVerdict) {
  const auto verdict_pixel = [](Verdict verdict) {
    FrameScene scene = four_points();
    scene.report.health.verdict = verdict;
    return colour_at(decoded(to_png(camera_picture(scene))), 752 + 280, 50);
  };
  EXPECT_EQ(verdict_pixel(Verdict::trusted), palette::kTrusted);
  EXPECT_EQ(verdict_pixel(Verdict::degraded), palette::kDegraded);
  EXPECT_EQ(verdict_pixel(Verdict::untrusted), palette::kUntrusted);
}

TEST(CameraPicture, WarnsOfMeasuresPastTheirLimits) {
  const auto painted = [](double sigma) {
    FrameScene scene = four_points();
    scene.report.health = {};
    scene.report.health.verdict = Verdict::trusted;
    scene.report.health.doubt = DistrustReason::none;
    scene.report.health.spread = 0.2;
    scene.report.health.position_sigma = sigma;
    cv::Mat warned;
    cv::inRange(decoded(to_png(camera_picture(scene))), cv::Scalar(0, 145, 230), cv::Scalar(0, 145, 230), warned);
    return cv::countNonZero(warned);
  };
  EXPECT_EQ(painted(0.01), 0);
  EXPECT_GT(painted(0.15), 100);
}

TEST(CameraPicture, ContainsEveryPointInSvg) {
  const std::string svg = to_svg(camera_picture(four_points()));
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(moves_in_class(svg, "offline-inliers"), 1);
  EXPECT_EQ(moves_in_class(svg, "online-inliers"), 1);
  EXPECT_EQ(moves_in_class(svg, "offline-outliers"), 2) << "two strokes of one cross";
  EXPECT_EQ(moves_in_class(svg, "online-outliers"), 2);
}

}  // namespace
}  // namespace byre
