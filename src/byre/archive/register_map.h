#pragma once

#include "byre/archive/register_picks.h"
#include "byre/floor_plan.h"
#include "byre/map/map_file.h"
#include "byre/map/plan_scale.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct RegisterOptions {
  PickOptions picks;
  PlanRegistrationOptions registration;
};

// What became of an attempt to find a map on a floor plan.
struct Registering {
  std::vector<PlanCorrespondence> correspondences;
  PlanFit fit;
  double largest_path_sigma = 0.0;  // metres: how well the plan knows the place of the path where it knows it worst
  std::optional<PlanScale> measured_scale;  // scale by the picks, of a map that was metric before
  bool has_baseline = false;                // whether the map has a baseline, where its scale is from
};

// A map whose scale was to be mended, and where it lies then.
struct MendedMap {
  StoredMap stored;
  Registering registering;  // place of the mended map; but its scale is as measured before
  double factor = 1.0;      // length now over length before; 1 where there was nothing to mend
};

// Throws InputError, naming the file of the picks or of the map, for what cannot be registered.
Registering register_map(const StoredMap& stored, const std::filesystem::path& map, const FloorPlan& plan,
                         const std::filesystem::path& picks, const RegisterOptions& options);

// Registers the map, which becomes as large as the picks say, with its baselines, where it differs by more than the
// uncertainty of that explains. Throws InputError also where no baseline tells the map's scale, or the picks do not.
MendedMap mend_scale(StoredMap stored, const std::filesystem::path& map, const FloorPlan& plan,
                     const std::filesystem::path& picks, const RegisterOptions& options);

// A line for people: where the map's origin lies on the plan.
std::string describe_origin(const PlanRegistration& registration);

}  // namespace byre
