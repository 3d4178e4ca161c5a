#pragma once

#include "byre/floor_plan.h"
#include "byre/map/map_file.h"
#include "byre/map/plan/plan_matching.h"
#include "byre/map/plan/plan_places.h"
#include "byre/map/plan/plan_scale.h"

#include <filesystem>
#include <optional>
#include <string>
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

struct RegisterOptions {
  PickOptions picks;
  PlanRegistrationOptions registration;
  std::vector<Tag> tags{};  // surveyed ones of the map are picks as well
};

// Result of the registration of a map on a floor plan.
struct Registering {
  std::vector<PlanCorrespondence> correspondences;
  PlanFit fit;
  double largest_path_sigma = 0.0;          // metres, position on the plan; largest along the path
  std::optional<PlanScale> measured_scale;  // scale by the picks, for a metric map
  bool has_baseline = false;                // whether the map's scale comes from a stereo baseline
  std::optional<PlanMatch> match = {};      // with register_by_walls(): without correspondences
};

// A map after correction of its scale, and its registration.
struct ScaleCorrectedMap {
  StoredMap stored;
  Registering registering;  // result for the corrected map; measured_scale is that before the correction
  double factor = 1.0;      // new over old length; 1 without a correction
};

// picks: empty for tags alone. Throws InputError naming the file of the picks or of the map if the registration is
// impossible.
Registering register_map(const StoredMap& stored, const std::filesystem::path& map, const FloorPlan& plan,
                         const std::filesystem::path& picks, const RegisterOptions& options);

// Registers the map by its walls, see match_with_plan(). body_height: empty if unknown. Throws InputError naming the
// map and the rival pose unless the result is unambiguous, and for maps without a metric scale.
Registering register_by_walls(const StoredMap& stored, const std::filesystem::path& map, const DrawnFloorPlan& plan,
                              std::optional<double> body_height);

// Registers the map and corrects its scale and baselines by the picks if the difference is significant. Throws
// InputError also if the map's scale does not come from a baseline, or the picks do not determine it.
ScaleCorrectedMap correct_scale(StoredMap stored, const std::filesystem::path& map, const FloorPlan& plan,
                                const std::filesystem::path& picks, const RegisterOptions& options);

// Text line with the position of the map's origin on the plan.
std::string describe_origin(const PlanRegistration& registration);

}  // namespace byre
