#pragma once

#include "byre/floor_plan.h"
#include "byre/map/plan_places.h"

#include <filesystem>
#include <vector>

namespace byre {

struct PickOptions {
  double sigma = PlanCorrespondence{}.sigma;  // metres, for picks that say nothing else
  double positions_scale = 1.0;               // lengths in the map now over those when its positions were picked
};

// Correspondences of a map and a plan from a table (CSV) whose first line names its columns: docs/floor_plan.md has the
// list. Throws InputError naming the line for a row that does not say one place on the plan and one in the map, and for
// points, keyframes and pixels that the map knows nothing of.
std::vector<PlanCorrespondence> read_plan_correspondences(const std::filesystem::path& path, const FloorPlan& plan,
                                                          const StoredMap& stored, const PickOptions& options);

// Whether a row gives a position in the map, which is not one in a map of another scale. Throws InputError as above for
// a file that is no table.
bool gives_positions(const std::filesystem::path& path);

}  // namespace byre
