#include "byre/io/image/plan_file.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"

#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kExact = 1e-9;  // metres

// Three columns and two rows with the lower left corner at the given point.
FloorPlan plan_of_six_pixels(const Eigen::Vector2d& corner, double yaw) {
  FloorPlan plan;
  plan.width = 3;
  plan.height = 2;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(yaw).toRotationMatrix();
  plan.metres_per_pixel = 0.05 * turn * Eigen::Vector2d(1.0, -1.0).asDiagonal();
  plan.top_left_in_plan = corner - plan.metres_per_pixel * Eigen::Vector2d(-0.5, 1.5);
  plan.occupied_threshold = 0.65;
  return plan;
}

const std::vector<std::int8_t> kSixPixels = {kFreePixel,    kOccupiedPixel, kUnknownPixel,
                                             kUnknownPixel, kUnknownPixel,  kOccupiedPixel};

class PlanFile : public TestFolder {
 protected:
  std::string content_of(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(PlanFile, IsReadAsWritten) {
  for (const double yaw : {0.0, 0.25 * std::numbers::pi, -2.0}) {
    const FloorPlan written = plan_of_six_pixels({-12.35, 6.7}, yaw);
    write_floor_plan(written, kSixPixels, folder_ / "grid.pgm");
    const DrawnFloorPlan read = read_drawn_floor_plan(folder_ / "grid.yaml");
    EXPECT_EQ(read.occupancy, kSixPixels);
    EXPECT_EQ(read.plan.width, 3);
    EXPECT_EQ(read.plan.height, 2);
    EXPECT_EQ(read.plan.occupied_threshold, written.occupied_threshold);
    EXPECT_EQ(read.plan.mode, PlanMode::trinary);
    EXPECT_FALSE(read.plan.is_negated);
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0.0, 0.0), {2.0, 1.0}, {-0.5, 1.5}}) {
      EXPECT_THAT(read.plan.point_at(pixel), PointNear(written.point_at(pixel), kExact));
    }
  }
}

TEST_F(PlanFile, HasTheFormatOfMapServer) {
  write_floor_plan(plan_of_six_pixels({-1.0, 2.5}, 0.0), kSixPixels, folder_ / "grid.pgm");
  EXPECT_EQ(content_of("grid.pgm"), std::string("P5\n3 2\n255\n\xfe\x00\xcd\xcd\xcd\x00", 17));
  EXPECT_EQ(content_of("grid.yaml"),
            "image: grid.pgm\nresolution: 0.05\norigin: [-1, 2.5, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
            "free_thresh: 0.196\nmode: trinary\n");
}

TEST_F(PlanFile, QuotesAnImageNameThatIsNoPlainText) {
  const FloorPlan plan = plan_of_six_pixels({0.0, 0.0}, 0.0);
  write_floor_plan(plan, kSixPixels, folder_ / "barn: #2.pgm");
  EXPECT_EQ(read_drawn_floor_plan(folder_ / "barn: #2.yaml").occupancy, kSixPixels);
}

TEST_F(PlanFile, ReplacesAnOlderOne) {
  const FloorPlan plan = plan_of_six_pixels({0.0, 0.0}, 0.0);
  write_floor_plan(plan, std::vector<std::int8_t>(6, kUnknownPixel), folder_ / "grid.pgm");
  write_floor_plan(plan, kSixPixels, folder_ / "grid.pgm");
  EXPECT_EQ(read_drawn_floor_plan(folder_ / "grid.yaml").occupancy, kSixPixels);
}

TEST_F(PlanFile, ReplacesNoFileOfAnotherKind) {
  write("grid.pgm", "not an image");
  EXPECT_THAT(error_of([&] {
                write_floor_plan(plan_of_six_pixels({0.0, 0.0}, 0.0), kSixPixels, folder_ / "grid.pgm");
              }),
              HasSubstr("grid.pgm: "));
  EXPECT_THAT(content_of("grid.pgm"), StartsWith("not an image"));
}

}  // namespace
}  // namespace byre
