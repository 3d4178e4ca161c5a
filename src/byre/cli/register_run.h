#pragma once

#include "byre/dataset/floor_plan.h"
#include "byre/map/floor_plan.h"
#include "byre/map/map_file.h"

#include <filesystem>
#include <vector>

namespace byre::cli {

struct RegisterOptions {
  double pick_sigma = PlanCorrespondence{}.sigma;  // metres, of picks that say nothing else
  PlanRegistrationOptions registration;
};

// What became of an attempt to find a map on a floor plan.
struct Registering {
  std::vector<PlanCorrespondence> correspondences;
  PlanFit fit;
  double largest_path_sigma = 0.0;  // metres: how well the plan knows the place of the path where it knows it worst
};

// Throws InputError, naming the file of the picks or of the map, for what cannot be registered.
Registering register_map(const StoredMap& stored, const std::filesystem::path& map, const FloorPlan& plan,
                         const std::filesystem::path& picks, const RegisterOptions& options);

}  // namespace byre::cli
