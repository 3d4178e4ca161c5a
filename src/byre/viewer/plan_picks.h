#pragma once

#include "byre/map/map_file.h"
#include "byre/map/plan/floor_plan.h"

#include <string>
#include <vector>

namespace byre {

// Map point with its position on the plan, picked by a user.
struct PlanPick {
  std::string name;                                         // no commas or line breaks
  std::uint32_t point = 0;                                  // index of the map point
  Eigen::Vector2d point_in_plan = Eigen::Vector2d::Zero();  // metres
};

// Parses the page's JSON: {"picks": [{"name": "gate post", "point": 17, "plan": [12.4, 3.85]}]}. Commas and line breaks
// in names become spaces. Throws InputError for other input, and for points missing in the map.
std::vector<PlanPick> parse_plan_picks(const std::string& json, const MapGraph& map);

// Residual in metres that the user has accepted ("accepted_residual_m" in the JSON); default kLargePlanResidual.
double accepted_residual(const std::string& json);

// pick_sigma: standard deviation of x and y of the picks, metres. Precondition: the map has the points.
std::vector<PlanCorrespondence> correspondences_of(const std::vector<PlanPick>& picks, const StoredMap& stored,
                                                   double pick_sigma);

// CSV in the columns of "byre register".
std::string picks_csv(const std::vector<PlanPick>& picks);

}  // namespace byre
