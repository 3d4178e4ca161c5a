#pragma once

#include "byre/map/plan/floor_plan.h"
#include "byre/map/plan/occupancy_grid.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace byre {

// Reasons not to accept the best pose of a map on a plan.
enum class PlanMatchDoubt : std::uint8_t {
  ambiguous,     // another pose explains the map nearly as well: a symmetric plan
  undetermined,  // a slightly moved pose explains the map nearly as well: parallel walls alone
  poor,          // half of the obstacles are not on walls of the plan, or driven ground is
};
std::string_view to_string(PlanMatchDoubt doubt);  // a sentence with the remedy

// Another pose of the map on the plan, relative to the best one.
struct PlanRival {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // middle of the path, metres on the plan
  double turn = 0.0;                                // radians, anticlockwise
  double margin = 0.0;                              // sigmas by which the best pose explains the map better
};

// Result of matching a map with a plan.
struct PlanMatch {
  PlanFit fit;             // best pose; residuals of obstacles on walls, one per half metre
  double explained = 0.0;  // share of the obstacles that are on walls of the plan
  PlanRival rival;         // with the smallest margin
  std::optional<PlanMatchDoubt> doubt;
};

// "obstacles on walls: 94 %; the next best pose, shifted by 3.20 m and turned by 180 deg, is worse by 7.1 sigmas (2.5
// needed)"
std::string describe_match(const PlanMatch& match);

// Margin, sigmas, by which the best pose must exceed each distinct rival.
inline constexpr double kLeastMatchMargin = 2.5;

// Finds the pose of a metric map on a plan by its occupancy grid, over all positions and headings. Obstacles are
// expected on walls of the plan; free and driven ground is not (correlative matching, Olson 2009). The best pose is
// compared with each local maximum of the likelihood that is more than 0.5 m or 5 degrees away, and with poses at that
// distance, by the test of Vuong (1989) on the log-likelihoods of squares of 0.5 m: neighbouring cells are correlated.
// The best pose is fitted to the middle lines of the walls; its covariance counts the errors of walls as few. Empty for
// a plan without walls, and for a map without obstacles or a planar path. Throws InputError as occupancy_grid().
std::optional<PlanMatch> match_with_plan(const MapGraph& map, const DrivingPlane& plane, const DrawnFloorPlan& plan,
                                         std::optional<double> body_height = {});

}  // namespace byre
