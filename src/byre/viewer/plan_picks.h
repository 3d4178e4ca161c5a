#pragma once

#include "byre/map/floor_plan.h"
#include "byre/map/map_file.h"

#include <string>
#include <vector>

namespace byre {

// A point of a map that was picked together with its place on the plan.
struct PlanPick {
  std::string name;                                         // holds no commas and no line ends
  std::uint32_t point = 0;                                  // number of a point of the map
  Eigen::Vector2d point_in_plan = Eigen::Vector2d::Zero();  // metres
};

// From the page's JSON: {"picks": [{"name": "gate post", "point": 17, "plan": [12.4, 3.85]}]}. Commas and line ends in
// names become spaces. Throws InputError for anything else, and for points that the map does not have.
std::vector<PlanPick> parse_plan_picks(const std::string& json, const Map& map);

// What somebody was told that the map is off by, in metres, and wants it saved all the same ("accepted_residual_m"
// beside the picks); kFarOffPlan where nobody was asked.
double accepted_residual(const std::string& json);

// pick_sigma: of x and of y as picked on the plan, metres. Precondition: the map has the points.
std::vector<PlanCorrespondence> correspondences_of(const std::vector<PlanPick>& picks, const StoredMap& stored,
                                                   double pick_sigma);

// In the columns that "byre register" reads.
std::string picks_csv(const std::vector<PlanPick>& picks);

}  // namespace byre
