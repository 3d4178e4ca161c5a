#pragma once

#include "byre/floor_plan.h"
#include "byre/map/plan/plan_places.h"

#include <filesystem>
#include <vector>

namespace byre {

struct PickOptions {
  double sigma = PlanCorrespondence{}.sigma;  // metres, for picks without a sigma
  double positions_scale = 1.0;               // current length over length at the time of picking positions
  double body_height = 0.0;                   // metres, of the body's origin above the floor: for feet of walls
};

// Correspondences of a map and a plan from a table (CSV) with column names in its first line;
// docs/reference/floor_plan.md lists the columns. Throws InputError naming the line for a row without exactly one
// position on the plan and one in the map, and for points, keyframes and pixels that do not exist in the map.
std::vector<PlanCorrespondence> read_plan_correspondences(const std::filesystem::path& path, const FloorPlan& plan,
                                                          const StoredMap& stored, const PickOptions& options);

// Whether any row gives a position in the map, which becomes invalid when the map's scale changes. Throws InputError
// like read_plan_correspondences if the file is not a table.
bool has_positions(const std::filesystem::path& path);

}  // namespace byre
