#include "byre/floor_plan.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kExact = 1e-9;  // metres, pixels

class FloorPlans : public TestFolder {
 protected:
  FloorPlans() { write_image("plan.png", 200, 100, 254); }

  FloorPlan from_yaml(const std::string& text) const {
    write("plan.yaml", text);
    return read_floor_plan(folder_ / "plan.yaml");
  }
  FloorPlan from_world_file(const std::string& text) const {
    write("plan.pgw", text);
    return read_floor_plan(folder_ / "plan.png");
  }
  std::string fault_in_yaml(const std::string& text) const {
    return error_of([&] { from_yaml(text); });
  }
  std::string fault_in_world_file(const std::string& text) const {
    return error_of([&] { from_world_file(text); });
  }
};

TEST_F(FloorPlans, PlaceTheOriginOfMapServerAtTheLowerLeftCorner) {
  const FloorPlan plan = from_yaml("image: plan.png\nresolution: 0.05\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\n");
  EXPECT_EQ(plan.name, "plan.yaml");
  EXPECT_EQ(plan.width, 200);
  EXPECT_EQ(plan.height, 100);
  EXPECT_THAT(plan.point_at({-0.5, 99.5}), PointNear(Eigen::Vector2d(-1.0, -2.0), kExact));
  EXPECT_THAT(plan.point_at({199.5, -0.5}), PointNear(Eigen::Vector2d(9.0, 3.0), kExact));
  EXPECT_THAT(plan.pixel_at({-0.975, -1.975}), PointNear(Eigen::Vector2d(0.0, 99.0), kExact));
}

TEST_F(FloorPlans, ApplyTheThresholdsOfTheYaml) {
  const std::string lies = "image: plan.png\nresolution: 0.05\norigin: [0, 0, 0]\n";
  EXPECT_FALSE(from_yaml(lies).occupied_threshold);
  EXPECT_EQ(from_yaml(lies + "occupied_thresh: 0.65\n").occupied_threshold, 0.65);
  EXPECT_FALSE(from_yaml(lies + "negate: 0\n").is_negated);
  EXPECT_TRUE(from_yaml(lies + "negate: 1\n").is_negated);
  EXPECT_THAT(fault_in_yaml(lies + "occupied_thresh: 65\n"), HasSubstr("occupied_thresh: is not between 0 and 1"));
  EXPECT_FALSE(from_world_file("0.05\n0\n0\n-0.05\n0\n0\n").occupied_threshold);
}

TEST_F(FloorPlans, RotateAboutTheLowerLeftCorner) {
  const FloorPlan plan = from_yaml("image: plan.png\nresolution: 0.05\norigin: [3, 4, 1.5707963267948966]\n");
  EXPECT_THAT(plan.point_at({-0.5, 99.5}), PointNear(Eigen::Vector2d(3.0, 4.0), kExact));
  EXPECT_THAT(plan.point_at({199.5, 99.5}), PointNear(Eigen::Vector2d(3.0, 14.0), kExact));
  EXPECT_THAT(plan.point_at({-0.5, -0.5}), PointNear(Eigen::Vector2d(-2.0, 4.0), kExact));
}

TEST_F(FloorPlans, ApplyTheWorldFile) {
  const FloorPlan plan = from_world_file("0.05\n0\n0\n-0.05\n500000.025\n5400000.975\n");
  EXPECT_EQ(plan.name, "plan.png");
  EXPECT_THAT(plan.point_at({0.0, 0.0}), PointNear(Eigen::Vector2d(500000.025, 5400000.975), kExact));
  EXPECT_THAT(plan.point_at({10.0, 20.0}), PointNear(Eigen::Vector2d(500000.525, 5399999.975), 2 * kExact));
  const Eigen::Vector2d pixel(123.25, 45.5);
  EXPECT_THAT(plan.pixel_at(plan.point_at(pixel)), PointNear(pixel, 1e-6));
}

TEST_F(FloorPlans, ApplyARotatedWorldFile) {
  const FloorPlan plan = from_world_file("0\n0.1\n0.1\n0\n10\n20\n");
  EXPECT_THAT(plan.point_at({5.0, 0.0}), PointNear(Eigen::Vector2d(10.0, 20.5), kExact));
  EXPECT_THAT(plan.point_at({0.0, 5.0}), PointNear(Eigen::Vector2d(10.5, 20.0), kExact));
}

TEST_F(FloorPlans, FindAllUsualNamesOfWorldFiles) {
  for (const char* const name : {"plan.pgw", "plan.pngw", "plan.wld"}) {
    write(name, "1\n0\n0\n-1\n7\n8\n");
    EXPECT_THAT(read_floor_plan(folder_ / "plan.png").top_left_in_plan, PointNear(Eigen::Vector2d(7.0, 8.0), kExact));
    std::filesystem::remove(folder_ / name);
  }
}

TEST_F(FloorPlans, ReportTheInvalidField) {
  EXPECT_THAT(error_of([&] { read_floor_plan(folder_ / "absent.yaml"); }), HasSubstr("absent.yaml: cannot be opened"));
  EXPECT_THAT(fault_in_yaml("image: [\n"), HasSubstr("correct the YAML"));
  EXPECT_THAT(fault_in_yaml("3\n"), HasSubstr("is not a YAML mapping of named fields"));
  EXPECT_THAT(fault_in_yaml("resolution: 0.05\norigin: [0, 0, 0]\n"), HasSubstr("plan.yaml: image: is missing"));
  EXPECT_THAT(fault_in_yaml("image: plan.png\norigin: [0, 0, 0]\n"), HasSubstr("resolution: is missing"));
  for (const char* const resolution : {"-1", "0", "-0.05"}) {
    EXPECT_THAT(fault_in_yaml("image: plan.png\nresolution: " + std::string(resolution) + "\n"),
                HasSubstr("resolution: is not positive"));
  }
  for (const char* const resolution : {"1e308", "1e4", "1e-6"}) {
    EXPECT_THAT(fault_in_yaml("image: plan.png\nresolution: " + std::string(resolution) + "\norigin: [0, 0, 0]\n"),
                HasSubstr("metres per pixel, outside 0.0001 to 100"));
  }
  for (const char* const resolution : {".nan", "nan", "-nan", ".inf", "1e999", "five"}) {
    EXPECT_THAT(fault_in_yaml("image: plan.png\nresolution: " + std::string(resolution) + "\norigin: [0, 0, 0]\n"),
                HasSubstr("resolution: is not a number"));
  }
  EXPECT_THAT(fault_in_yaml("image: plan.png\nresolution: 1\norigin: [0, 0, .nan]\n"), HasSubstr("is not a number"));
  EXPECT_THAT(fault_in_yaml("image: plan.png\nresolution: 1\norigin: [1e300, 0, 0]\n"),
              HasSubstr("origin: is more than a million kilometres away"));
  EXPECT_THAT(fault_in_yaml("image: plan.png\nresolution: 1\norigin: [0, 0]\n"),
              HasSubstr("not a list of three numbers"));
  EXPECT_THAT(fault_in_yaml("image: plan.png\nresolution: 1\norigin: [0, a, 0]\n"), HasSubstr("is not a number"));
  EXPECT_THAT(fault_in_yaml("image: no.png\nresolution: 1\norigin: [0, 0, 0]\n"), HasSubstr("no.png: cannot be read"));
}

TEST_F(FloorPlans, RejectInvalidWorldFiles) {
  EXPECT_THAT(error_of([&] { read_floor_plan(folder_ / "plan.png"); }), HasSubstr("has no world file in its folder"));
  EXPECT_THAT(fault_in_world_file("1\n0\n0\n-1\n7\n"), HasSubstr("plan.pgw: has 5 lines instead of six"));
  EXPECT_THAT(fault_in_world_file("1\n0\n0\nx\n7\n8\n"), HasSubstr("plan.pgw:4: is not a number"));
  EXPECT_THAT(fault_in_world_file("1\n0\n0\n1\n7\n8\n"), HasSubstr("has a mirrored or degenerate transform"));
  EXPECT_THAT(fault_in_world_file("1e308\n0\n0\n-1e308\n0\n0\n"), HasSubstr("has pixels larger than 100 m"));
  EXPECT_THAT(fault_in_world_file("1e-6\n0\n0\n-1e-6\n11.2\n48.1\n"), AllOf(HasSubstr("degrees"), HasSubstr("UTM")));
}

TEST_F(FloorPlans, RejectMoreThanAHundredMillionPixelsUndecoded) {
  write("plan.pgm", "P5\n30000 30000\n255\n");
  EXPECT_THAT(fault_in_yaml("image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n"),
              HasSubstr("plan.pgm: has 30000 x 30000 pixels; the limit for floor plans is 100 million"));
}

}  // namespace
}  // namespace byre
