#pragma once

#include "byre/floor_plan.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Map of one floor of one building.
struct SiteMap {
  std::string name;
  std::filesystem::path map;
  std::optional<std::filesystem::path> plan{};  // floor plan on which the map is registered
  std::optional<DrawnFloorPlan> drawn_plan{};   // walls of the plan (read_drawn_floor_plan), which limit relocalisation
  double height = 0.0;                          // metres, of the floor above a reference of the site
  std::string building{};
};

// A lift hides its motion from the cameras: poses in its region are not trusted.
enum class LinkKind : std::uint8_t { gate, stairs, lift };

std::string_view to_string(LinkKind kind);

// Region of one map from which the robot reaches another map.
struct SiteLink {
  LinkKind kind = LinkKind::gate;
  std::size_t from = 0;                    // index into Site::maps
  std::size_t to = 0;                      // index into Site::maps
  std::vector<Eigen::Vector2d> polygon{};  // corners on the floor plan, metres; empty: a sphere in the map's frame
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // metres
  double radius = 0.0;                               // metres
};

// Floors and buildings of one robot, each with a map.
struct Site {
  std::string name;
  std::vector<SiteMap> maps;  // not empty
  std::vector<SiteLink> links;
};

// Whether a file is read as a site where a map is expected: by its extension, .yaml or .yml.
inline bool is_site_file(const std::filesystem::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

// Reads docs/reference/site_file.md. Paths are relative to its folder. Throws InputError naming file and field; maps
// and plans are not opened.
Site read_site(const std::filesystem::path& path);

}  // namespace byre
