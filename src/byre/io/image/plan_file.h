#pragma once

#include "byre/floor_plan.h"
#include "byre/site.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

namespace byre {

// Path of the description that is written next to the image of a plan: FILE.yaml.
std::filesystem::path plan_description(const std::filesystem::path& image);

// Writes occupancy as a PGM image and its description, in the format of ROS' map_server (mode trinary): pixels of 100
// are black, of 0 nearly white (254), others grey (205). read_drawn_floor_plan reads the same occupancy. occupancy: of
// the plan's pixels, as in DrawnFloorPlan. Preconditions: square pixels, not mirrored. Throws InputError on failure.
void write_floor_plan(const FloorPlan& plan, std::span<const std::int8_t> occupancy,
                      const std::filesystem::path& image);

// The two files of a plan, for a copy of both: the YAML file and its image, or the image and its world file. Throws
// InputError as read_drawn_floor_plan, and for a YAML file that names its image with a folder.
std::array<std::filesystem::path, 2> files_to_copy(const std::filesystem::path& plan);

// read_site, then read_drawn_floor_plan of each plan. Throws InputError like both.
Site read_site_with_plans(const std::filesystem::path& path);

}  // namespace byre
