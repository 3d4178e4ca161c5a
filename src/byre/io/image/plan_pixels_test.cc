// Pixels of floor plans against the rules of ROS 2's nav2_map_server.

#include "byre/io/image/plan_pixels.h"

#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

FloorPlan plan_of(PlanMode mode, bool is_negated = false) {
  FloorPlan plan;
  plan.mode = mode;
  plan.is_negated = is_negated;
  plan.occupied_threshold = 0.65;
  return plan;
}

int grey(double value, const FloorPlan& plan) {
  return occupancy_of({value}, plan);
}

TEST(PlanPixels, AreOccupiedFreeOrUnknownByThresholds) {
  const FloorPlan plan = plan_of(PlanMode::trinary), negated = plan_of(PlanMode::trinary, true);
  const std::vector<std::array<int, 3>> table = {// grey value, occupancy, occupancy with negate: 1
                                                 {0, 100, 0},   {49, 100, 0},  {50, 100, -1},  {89, 100, -1},
                                                 {90, -1, -1},  {165, -1, -1}, {166, -1, 100}, {205, -1, 100},
                                                 {206, 0, 100}, {254, 0, 100}, {255, 0, 100}};
  for (const auto& [value, occupancy, when_negated] : table) {
    EXPECT_EQ(grey(value, plan), occupancy) << value;
    EXPECT_EQ(grey(value, negated), when_negated) << value;
  }
}

TEST(PlanPixels, ApplyTheThresholdsOfThePlan) {
  FloorPlan plan = plan_of(PlanMode::trinary);
  plan.occupied_threshold = 0.15;
  plan.free_threshold = 0.1;
  EXPECT_EQ(grey(205, plan), 100);
  EXPECT_EQ(grey(220, plan), -1);
  EXPECT_EQ(grey(254, plan), 0);
  plan.occupied_threshold = 0.2;
  EXPECT_EQ(grey(204, plan), -1) << "a darkness of 0.2 is not above it";
  EXPECT_EQ(grey(203, plan), 100);
  plan.occupied_threshold.reset();
  EXPECT_EQ(grey(89, plan), 100) << "default of 0.65";
}

TEST(PlanPixels, AreLinearBetweenTheThresholdsInModeScale) {
  const FloorPlan plan = plan_of(PlanMode::scale), negated = plan_of(PlanMode::scale, true);
  EXPECT_EQ(grey(0, plan), 100);
  EXPECT_EQ(grey(90, plan), 99);
  EXPECT_EQ(grey(147, plan), 50);
  EXPECT_EQ(grey(205, plan), 0);
  EXPECT_EQ(grey(254, plan), 0);
  EXPECT_EQ(grey(108, negated), 50);
  EXPECT_EQ(grey(254, negated), 100);
}

TEST(PlanPixels, AreGreyValuesInModeRaw) {
  for (const bool is_negated : {false, true}) {
    const FloorPlan plan = plan_of(PlanMode::raw, is_negated);
    EXPECT_EQ(grey(0, plan), 0);
    EXPECT_EQ(grey(37, plan), 37);
    EXPECT_EQ(grey(100, plan), 100);
    EXPECT_EQ(grey(101, plan), -1);
    EXPECT_EQ(grey(255, plan), -1);
  }
}

TEST(PlanPixels, AreUnknownWhereTransparent) {
  for (const PlanMode mode : {PlanMode::trinary, PlanMode::scale, PlanMode::raw}) {
    for (const double shade : {0.0, 255.0}) {
      EXPECT_EQ(occupancy_of({shade, 0.0}, plan_of(mode)), -1);
      EXPECT_EQ(occupancy_of({shade, 0.0}, plan_of(mode, true)), -1);
    }
  }
  const FloorPlan trinary = plan_of(PlanMode::trinary), scale = plan_of(PlanMode::scale);
  EXPECT_EQ(occupancy_of({0.0, 255.0}, trinary), 100);
  EXPECT_EQ(occupancy_of({0.0, 128.0}, trinary), 100) << "alpha is one of four channels of the mean";
  EXPECT_EQ(occupancy_of({255.0, 128.0}, trinary), 0);
  EXPECT_EQ(occupancy_of({255.0, 20.0}, trinary), -1);
  EXPECT_EQ(occupancy_of({100.0, 255.0}, trinary), -1) << "its darkness is 0.456";
  EXPECT_EQ(occupancy_of({0.0, 254.0}, scale), -1);
  EXPECT_EQ(occupancy_of({0.0, 255.0}, scale), 100);
}

class PlanImages : public TestFolder {
 protected:
  DrawnFloorPlan read(const cv::Mat& image, const std::string& fields = "") const {
    cv::imwrite((folder_ / "plan.png").string(), image);
    write("plan.yaml", "image: plan.png\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\n" + fields);
    return read_drawn_floor_plan(folder_ / "plan.yaml");
  }
};

TEST_F(PlanImages, StartWithTheTopRow) {
  const cv::Mat image = (cv::Mat_<std::uint8_t>(2, 3) << 0, 254, 205, 254, 0, 254);
  EXPECT_THAT(read(image).occupancy, ElementsAre(100, 0, -1, 0, 100, 0));
  EXPECT_THAT(read(image).image.pixels, ElementsAre(0, 254, 205, 254, 0, 254));
  EXPECT_THAT(read(255 - image, "negate: 1\n").occupancy, ElementsAre(100, 0, -1, 0, 100, 0));
  EXPECT_THAT(read(255 - image, "negate: 1\n").image.pixels, ElementsAre(0, 254, 205, 254, 0, 254))
      << "pixels as displayed";
}

TEST_F(PlanImages, AcceptSixteenBits) {
  const cv::Mat image = (cv::Mat_<std::uint16_t>(1, 4) << 0, 65535, 22938, 22937);
  EXPECT_THAT(read(image).occupancy, ElementsAre(100, 0, -1, 100));
}

TEST_F(PlanImages, AverageColours) {
  // Channels are blue, green, red. A grey image by luminance would make the green pixel bright.
  const cv::Mat image =
      (cv::Mat_<cv::Vec3b>(1, 3) << cv::Vec3b(255, 255, 255), cv::Vec3b(0, 255, 0), cv::Vec3b(0, 0, 255));
  EXPECT_THAT(read(image).occupancy, ElementsAre(0, 100, 100));
}

TEST_F(PlanImages, AreUnknownAndWhiteWhereTransparent) {
  const cv::Mat image =
      (cv::Mat_<cv::Vec4b>(1, 3) << cv::Vec4b(0, 0, 0, 0), cv::Vec4b(254, 254, 254, 255), cv::Vec4b(0, 0, 0, 255));
  EXPECT_THAT(read(image).occupancy, ElementsAre(-1, 0, 100));
  EXPECT_THAT(read(image).image.pixels, ElementsAre(255, 254, 0));
}

TEST_F(PlanImages, AreNegatedByEverySpellingOfTrue) {
  const cv::Mat image = (cv::Mat_<std::uint8_t>(1, 1) << 254);
  for (const char* const word : {"1", "true", "True", "TRUE", "yes", "on"}) {
    EXPECT_THAT(read(image, "negate: " + std::string(word) + "\n").occupancy, ElementsAre(100)) << word;
  }
  for (const char* const word : {"0", "false", "False", "no", "off"}) {
    EXPECT_THAT(read(image, "negate: " + std::string(word) + "\n").occupancy, ElementsAre(0)) << word;
  }
}

TEST_F(PlanImages, ApplyTheirMode) {
  const cv::Mat image = (cv::Mat_<std::uint8_t>(1, 3) << 0, 60, 254);
  EXPECT_THAT(read(image, "mode: raw\n").occupancy, ElementsAre(0, 60, -1));
  EXPECT_THAT(read(image, "mode: Scale\nfree_thresh: 0.0\n").occupancy, ElementsAre(100, 100, 1));
  EXPECT_THAT(read(image, "mode: trinary\n").occupancy, ElementsAre(100, 100, 0));
}

TEST_F(PlanImages, RejectAnInvalidField) {
  const cv::Mat image = (cv::Mat_<std::uint8_t>(1, 1) << 0);
  const auto fault = [&](const std::string& fields) { return error_of([&] { read(image, fields); }); };
  EXPECT_THAT(fault("negate: perhaps\n"), HasSubstr("plan.yaml: negate: is not 0, 1, true or false"));
  EXPECT_THAT(fault("mode: binary\n"), HasSubstr("plan.yaml: mode: is not trinary, scale or raw"));
  EXPECT_THAT(fault("free_thresh: 20\n"), HasSubstr("free_thresh: is not between 0 and 1"));
  EXPECT_THAT(fault("mode: scale\nfree_thresh: 0.7\n"), HasSubstr("free_thresh: is not below occupied_thresh"));
}

}  // namespace
}  // namespace byre
