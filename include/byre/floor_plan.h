#pragma once

#include "byre/image.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

namespace byre {

// How pixels are read as occupancy, as in ROS' map_server. A pixel's darkness is 0 for white and 1 for black, or the
// other way round where the plan is negated.
enum class PlanMode : std::uint8_t {
  trinary,  // darkness above occupied_threshold is occupied, below free_threshold free, between unknown
  scale,    // as trinary, with shares of 100 between the thresholds; pixels that are not opaque are unknown
  raw       // the grey value itself up to 100; above unknown. Neither thresholds nor negation apply
};

// Occupancy of a pixel: percent, or unknown.
inline constexpr std::int8_t kFreePixel = 0, kOccupiedPixel = 100, kUnknownPixel = -1;

// An image of a floor plan and where its pixels lie. The plan's frame is what its file says: metres on the floor, for a
// geo-referenced plan those of the projected coordinate system, which may be millions; seen from above, y is 90 degrees
// to the left of x. Pixels are continuous, whole numbers are centres, (0, 0) is that of the top left one.
struct FloorPlan {
  std::string name;             // name of the file that describes the plan
  std::filesystem::path image;  // path that can be opened as it is
  int width = 0;                // pixels
  int height = 0;
  Eigen::Matrix2d metres_per_pixel = Eigen::Matrix2d::Identity();  // columns: a step to the right, a step down
  Eigen::Vector2d top_left_in_plan = Eigen::Vector2d::Zero();      // centre of the top left pixel
  // Darkness, from 0 to 1, above which a pixel is occupied. Empty: dark pixels may be letters, so that the plan has no
  // walls; its occupancy is read with 0.65.
  std::optional<double> occupied_threshold{};
  double free_threshold = 0.196;  // darkness below which a pixel is free
  PlanMode mode = PlanMode::trinary;
  bool is_negated = false;  // white is occupied, black free

  // Metres on the plan and pixels of its image, which may lie outside of it.
  Eigen::Vector2d point_at(const Eigen::Vector2d& pixel) const { return top_left_in_plan + metres_per_pixel * pixel; }
  Eigen::Vector2d pixel_at(const Eigen::Vector2d& point_in_plan) const {
    return metres_per_pixel.inverse() * (point_in_plan - top_left_in_plan);
  }
};

// There are two ways to say where an image lies. NAME.yaml is as ROS' map_server has it: the image's file, metres per
// pixel (resolution), and the pose [x, y, yaw] of the lower left corner of the lower left pixel (origin);
// http://wiki.ros.org/map_server. occupied_thresh, free_thresh, negate and mode are optional. An image file has a world
// file beside it (.pgw, .tfw, .jgw; .pngw and the like; .wld) of six lines: the step to the right in x and in y, the
// step down in x and in y, the centre of the top left pixel. Throws InputError naming file and field when one of the
// two is missing, cannot be read or makes no sense.
FloorPlan read_floor_plan(const std::filesystem::path& path);

// A plan with the pixels of its image, row by row from the top left one.
struct DrawnFloorPlan {
  FloorPlan plan;
  Image image;                           // grey values to show: on white where transparent, inverted where negated
  std::vector<std::int8_t> occupancy{};  // 0 (free) to 100 (occupied), or -1 (unknown). Fully transparent: unknown
};

// Throws InputError when the image is not a whole one of 8 or 16 bits.
DrawnFloorPlan read_plan_pixels(const FloorPlan& plan);
DrawnFloorPlan read_drawn_floor_plan(const std::filesystem::path& path);  // read_floor_plan with its pixels

// The one beside an image, where there is one.
std::optional<std::filesystem::path> find_world_file(const std::filesystem::path& image);

}  // namespace byre
