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

// Interpretation of pixels as occupancy, by the rules of ROS 2's nav2_map_server. The darkness of a pixel is 0 for
// white and 1 for black; for a negated plan 1 for white and 0 for black.
enum class PlanMode : std::uint8_t {
  trinary,  // darkness above occupied_threshold is occupied, below free_threshold free, in between unknown
  scale,    // as trinary, but linear from 0 to 100 between the thresholds; pixels that are not opaque are unknown
  raw       // grey values up to 100, larger ones unknown; without thresholds and negation
};

// Occupancy of a pixel, percent, or unknown.
inline constexpr std::int8_t kFreePixel = 0, kOccupiedPixel = 100, kUnknownPixel = -1;

// An image of a floor plan and the position of its pixels. The plan's frame is that of its file: metres on the floor,
// for a geo-referenced plan those of the projected coordinate system, which may be millions; seen from above, y is 90
// degrees to the left of x. Pixels are continuous, whole numbers are centres, (0, 0) is that of the top left one.
struct FloorPlan {
  std::string name;             // name of the file that describes the plan
  std::filesystem::path image;  // path that can be opened as it is
  int width = 0;                // pixels
  int height = 0;
  Eigen::Matrix2d metres_per_pixel = Eigen::Matrix2d::Identity();  // columns: a step to the right, a step down
  Eigen::Vector2d top_left_in_plan = Eigen::Vector2d::Zero();      // centre of the top left pixel
  // Darkness, from 0 to 1, above which a pixel is occupied. Empty: the plan has no walls, as dark pixels may be
  // letters; its occupancy is read with 0.65.
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

// Reads NAME.yaml or an image with a world file. NAME.yaml has the format of ROS' map_server
// (http://wiki.ros.org/map_server): the image's file, metres per pixel (resolution), and the pose [x, y, yaw] of the
// lower left corner of the lower left pixel (origin); occupied_thresh, free_thresh, negate and mode are optional. A
// world file lies beside the image (.pgw, .tfw, .jgw; .pngw and the like; .wld) and has six lines: the step to the
// right in x and in y, the step down in x and in y, the centre of the top left pixel. Throws InputError with file and
// field if a file is missing, cannot be read or has an invalid value.
FloorPlan read_floor_plan(const std::filesystem::path& path);

// A plan with the pixels of its image, in rows from the top left pixel.
struct DrawnFloorPlan {
  FloorPlan plan;
  Image image;  // grey values for display: transparent pixels on white, a negated plan inverted
  std::vector<std::int8_t> occupancy{};  // 0 (free) to 100 (occupied), -1 (unknown); fully transparent pixels: -1
};

// Throws InputError if the image is damaged or has other than 8 or 16 bits.
DrawnFloorPlan read_plan_pixels(const FloorPlan& plan);
DrawnFloorPlan read_drawn_floor_plan(const std::filesystem::path& path);  // read_floor_plan with its pixels

// The one beside an image, where there is one.
std::optional<std::filesystem::path> find_world_file(const std::filesystem::path& image);

}  // namespace byre
