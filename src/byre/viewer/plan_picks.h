#pragma once

#include "byre/map/map_file.h"
#include "byre/map/plan/plan_places.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// Place of the map with its position on the plan, picked by a user: a map point, the body at a keyframe, a place seen
// in pictures, or with end_in_plan the foot of a wall, whose start and end are two pixels of one picture.
struct PlanPick {
  std::string name;  // no commas or line breaks
  std::optional<PointId> point;
  Eigen::Vector2d point_in_plan = Eigen::Vector2d::Zero();  // metres
  std::optional<KeyframeId> station{};
  std::vector<KeyframePixel> pixels{};
  std::optional<Eigen::Vector2d> end_in_plan{};
};

// Parses the page's JSON: {"picks": [{"name": "gate post", "plan": [12.4, 3.85], "point": 17}]}. Instead of "point":
// "station": keyframe, or "pixels": [[keyframe, u, v], ...], with "plan_end" for a wall. Commas and line breaks in
// names become spaces. Throws InputError for other input, and for points and keyframes missing in the map.
std::vector<PlanPick> parse_plan_picks(const std::string& json, const MapGraph& map);

// Parses {"pixels": [[keyframe, u, v], ...]}; u and v are shares of the picture's width and height.
std::vector<KeyframePixel> parse_picture_pixels(const std::string& json, const MapGraph& map);

// Whether the JSON is about the proposed registration instead of picks ("proposal": true).
bool is_about_proposal(const std::string& json);

// Residual in metres that the user has accepted ("accepted_residual_m" in the JSON); default kLargePlanResidual.
double accepted_residual(const std::string& json);

// Precondition: the map has the points and keyframes. Throws InputError naming the pick whose pixels are of different
// places, from too similar directions or above the floor. pick_sigma: of x and of y, metres. body_height: of the body's
// origin above the floor, metres, for feet of walls.
std::vector<PlanCorrespondence> correspondences_of(const std::vector<PlanPick>& picks, const StoredMap& stored,
                                                   const DrivingPlane& plane, double pick_sigma, double body_height);

// Place of pixels of several pictures. Throws InputError as correspondences_of().
MapPosition place_of_pixels(const std::string& name, const std::vector<KeyframePixel>& pixels, const StoredMap& stored);

// CSV in the columns of "byre register".
std::string picks_csv(const std::vector<PlanPick>& picks, const StoredMap& stored);

}  // namespace byre
