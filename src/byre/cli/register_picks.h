#pragma once

#include "byre/dataset/floor_plan.h"
#include "byre/map/plan_places.h"

#include <filesystem>
#include <vector>

namespace byre::cli {

// Correspondences of a map and a plan from a table (CSV) whose first line names its columns: docs/floor_plan.md has the
// list. pick_sigma: of picks that say nothing else, metres. Throws InputError naming the line for a row that does not
// say one place on the plan and one in the map, and for points, keyframes and pixels that the map knows nothing of.
std::vector<PlanCorrespondence> read_plan_correspondences(const std::filesystem::path& path, const FloorPlan& plan,
                                                          const StoredMap& stored, double pick_sigma);

}  // namespace byre::cli
