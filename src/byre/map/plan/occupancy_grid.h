#pragma once

#include "byre/floor_plan.h"
#include "byre/map/plan/driving_plane.h"
#include "byre/plan_registration.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace byre {

// Lengths in metres, heights above the floor that was driven on.
struct GridOptions {
  double resolution = 0.05;  // edge of a cell
  double low = 0.1;          // points between these heights are obstacles
  double high = 1.8;
  double footprint_radius = 0.3;  // the robot covers this disc around its body's origin
  int least_observations = 2;     // points with fewer are ignored
  double largest_sigma = 0.05;    // obstacles with a larger horizontal standard deviation are ignored
  // Height of the body's origin; ignored with a plan registration. Empty: zero if the body's z axis points up; unknown
  // for other bodies, such as a camera.
  std::optional<double> body_height{};
};

// Occupancy of the ground plane. Frame: that of the map's floor plan, else the ground frame: origin and x axis of the
// map projected onto the driving plane, z up from the floor.
struct OccupancyGrid {
  FloorPlan plan;                        // placement of the cells; without name and image file
  std::vector<std::int8_t> occupancy{};  // kFreePixel, kOccupiedPixel or kUnknownPixel; row-major from the top left
  Similarity plan_from_map{};            // frame of `plan` from the map frame
};

// Largest number of cells, as of a floor plan that can be read.
inline constexpr double kMaxGridCells = 100e6;

// Occupancy mapping by log-odds (Moravec and Elfes 1985) in horizontal layers, clamped and projected as by OctoMap
// (Hornung et al. 2013): a cell is occupied if it is in any layer. Each keyframe is one scan of the points it observes:
// a hit is spread by the covariance of its point, a ray misses up to three sigmas before it. Points on a line that a
// keyframe observes together are also hits between them, if closer than the robot's width and 0.6 m. Driven cells are
// free.
//
// The map is metric, or registered on a plan. plane: empty for that of the path and the images. Empty without
// keyframes, or if the path is not planar (flown or carried). Throws InputError for more than kMaxGridCells, and if the
// height of the body is unknown.
std::optional<OccupancyGrid> occupancy_grid(const MapGraph& map, const std::optional<PlanRegistration>& registration,
                                            const GridOptions& options = {}, std::optional<DrivingPlane> plane = {});

}  // namespace byre
