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

// Image of a floor plan with its georeference. Plan frame: that of the plan's file, metres on the floor, y 90 degrees
// to the left of x seen from above. For a geo-referenced plan it is the projected coordinate system; coordinates may be
// millions. Pixels are continuous: integers are pixel centres, (0, 0) is the centre of the top left one.
struct FloorPlan {
  std::string name;             // file name of the plan's description
  std::filesystem::path image;  // path of the image file, including the folder
  int width = 0;                // pixels
  int height = 0;
  Eigen::Matrix2d metres_per_pixel = Eigen::Matrix2d::Identity();  // columns: a step to the right, a step down
  Eigen::Vector2d top_left_in_plan = Eigen::Vector2d::Zero();      // centre of the top left pixel, metres
  // Darkness, 0 to 1, above which a pixel is occupied. Empty: dark pixels may be text, so the plan has no walls;
  // occupancy then uses 0.65.
  std::optional<double> occupied_threshold{};
  double free_threshold = 0.196;  // darkness below which a pixel is free
  PlanMode mode = PlanMode::trinary;
  bool is_negated = false;  // white is occupied, black is free

  // Conversion between plan coordinates (metres) and pixels, which may lie outside the image.
  Eigen::Vector2d point_at(const Eigen::Vector2d& pixel) const { return top_left_in_plan + metres_per_pixel * pixel; }
  Eigen::Vector2d pixel_at(const Eigen::Vector2d& point_in_plan) const {
    return metres_per_pixel.inverse() * (point_in_plan - top_left_in_plan);
  }
};

// Reads a plan from NAME.yaml or from an image with a world file.
//   NAME.yaml   format of ROS' map_server (http://wiki.ros.org/map_server): image file, metres per pixel (resolution),
//               pose [x, y, yaw] of the lower left corner of the lower left pixel (origin); optionally occupied_thresh,
//               free_thresh, negate and mode
//   world file  next to the image (.pgw, .tfw, .jgw, .pngw and the like, .wld); six lines: x and y of a step to the
//               right, x and y of a step down, x and y of the top left pixel's centre
// Throws InputError with file and field if a file is missing or unreadable, or a value is invalid.
FloorPlan read_floor_plan(const std::filesystem::path& path);

// Floor plan with its pixels, row-major from the top left.
struct DrawnFloorPlan {
  FloorPlan plan;
  Image image;  // grey values for display: transparent pixels are white, a negated plan is inverted
  std::vector<std::int8_t> occupancy{};  // 0 (free) to 100 (occupied), -1 (unknown); fully transparent pixels: -1
};

// Throws InputError if the image is damaged or its depth is not 8 or 16 bits.
DrawnFloorPlan read_plan_pixels(const FloorPlan& plan);
// read_floor_plan, then read_plan_pixels.
DrawnFloorPlan read_drawn_floor_plan(const std::filesystem::path& path);

// World file next to an image; empty if there is none.
std::optional<std::filesystem::path> find_world_file(const std::filesystem::path& image);

}  // namespace byre
