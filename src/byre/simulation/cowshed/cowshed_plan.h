#pragma once

#include "byre/image.h"
#include "byre/simulation/cowshed/cowshed.h"

#include <filesystem>
#include <vector>

namespace byre {

// Floor plan of a cowshed: image and placement, in the format of the ROS map_server.
struct FloorPlanImage {
  Image image;                                       // black: walls, posts, curbs; white: free space; north up
  double resolution = 0.02;                          // metres per pixel
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // lower left corner of the lower left pixel on the plan
};

// Plan coordinates are x and y of the world frame, metres (see CowshedOptions).
FloorPlanImage draw_floor_plan(const std::vector<PlanOutline>& outlines);

// A point correspondence for registering the map on the plan.
struct MarkPick {
  std::string name;
  Eigen::Vector3d point_in_map;
  Eigen::Vector2d point_in_plan;
};

// Picks of a barn's landmarks, in the frame of a map whose first frame has the given body pose
// (docs/explanation/conventions.md: the world of a map).
std::vector<MarkPick> picks_of(const std::vector<NamedPoint>& marks, const Pose& world_from_first_body);

// Observation of a landmark in a left image.
struct MarkSighting {
  std::string name;
  Timestamp time{};
  Eigen::Vector2d pixel;
};

// Writes plan.png, plan.yaml, picks.csv and pick_pixels.csv into a folder. Throws InputError when a file cannot be
// written.
void write_floor_plan(const FloorPlanImage& plan, const std::vector<MarkPick>& picks,
                      const std::vector<MarkSighting>& sightings, const std::filesystem::path& folder);

// Writes a file for read_tags. Throws InputError when it cannot be written.
void write_tags(const std::vector<Tag>& tags, const std::filesystem::path& path);

}  // namespace byre
