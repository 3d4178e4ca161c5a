#pragma once

#include "byre/image.h"
#include "byre/simulation/cowshed.h"

#include <filesystem>
#include <vector>

namespace byre {

// The floor plan of a cowshed: an image and where it lies, as ROS' map_server keeps them.
struct FloorPlanImage {
  Image image;                                       // black: walls, posts, curbs; white: free; its top is the north
  double resolution = 0.02;                          // metres per pixel
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // lower left corner of the lower left pixel on the plan
};

// On the plan lie the barn's own metres: x and y of the world frame, see CowshedOptions.
FloorPlanImage draw_floor_plan(const std::vector<PlanOutline>& outlines);

// A point as somebody would pick it for a registration of the map on the plan.
struct MarkPick {
  std::string name;
  Eigen::Vector3d point_in_map;
  Eigen::Vector2d point_in_plan;
};

// The named points of a barn, in the frame that a map has when it is made from a recording whose first frame has the
// body there (docs/conventions.md: the world of a map).
std::vector<MarkPick> picks_of(const std::vector<NamedPoint>& marks, const Pose& world_from_first_body);

// Where a named point is seen in an image of the left camera.
struct MarkSighting {
  std::string name;
  Timestamp time{};
  Eigen::Vector2d pixel;
};

// Writes plan.png, plan.yaml, picks.csv and pick_pixels.csv into a folder. Throws InputError when a file cannot be
// written.
void write_floor_plan(const FloorPlanImage& plan, const std::vector<MarkPick>& picks,
                      const std::vector<MarkSighting>& sightings, const std::filesystem::path& folder);

}  // namespace byre
