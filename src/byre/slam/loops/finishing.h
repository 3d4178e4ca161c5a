#pragma once

#include "byre/slam/loops/global_mapping.h"
#include "byre/slam/loops/loop_closing.h"
#include "byre/slam/loops/odometry_motions.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace byre {

struct FinishOptions {
  LoopOptions loops;
  GlobalMappingOptions global;
  std::vector<KeyframeMotion> motions;  // see odometry_motions
  // Number of the first new keyframe, added since the map was last finished. Parts far from new keyframes do not
  // change, see recent_map. 0: the whole map is new.
  std::uint32_t first_new = 0;
  std::vector<LoopEdge> joins{};  // loops by which submaps were joined, to be closed as well
};

// Quality of a map, measured without ground truth.
struct MapQuality {
  int keyframes = 0;
  int points = 0;
  int observations = 0;
  double reprojection_median = 0.0;  // pixels
  double reprojection_p95 = 0.0;     // pixels
  int parts = 0;                     // groups of keyframes that no shared point connects
};

struct FinishReport {
  int loops = 0;                       // loops found
  std::vector<double> loop_drifts;     // pixels of drift between both sides of a loop, see apparent_drift
  std::vector<double> loop_residuals;  // metres of disagreement between a loop and the final map
  int keyframes_removed = 0;           // redundant keyframes
  int points_removed = 0;              // weak points
  LengthChanges length_changes;        // scale changes for poses relative to keyframes, see apply_correction
  MapQuality before;
  MapQuality after;

  // Adds a later finishing of the same map, whose loops count once.
  void add(const FinishReport& again) {
    keyframes_removed += again.keyframes_removed;
    points_removed += again.points_removed;
    after = again.after;
  }
};

struct FinishHooks {
  std::function<bool()> should_stop;                  // polled; true keeps the present result
  std::function<void(const char* step)> before_step;  // "searching for loops", ...
};

MapQuality quality_of(const MapGraph& map);

// Loops of new keyframes that the map does not contain, each confirmed by the keyframes around. Searches from the
// newest keyframe backwards; skips keyframes around a found loop.
std::vector<LoopHypothesis> search_loops(const MapGraph& map, const PlaceIndex& places, const FinishOptions& options,
                                         const FinishHooks& hooks);

// Joins of a separate submap with the map, found at several keyframes and accepted by one test of all of them. Empty if
// the test does not accept them, or two contradict each other. keyframes: of the submap.
std::vector<LoopHypothesis> search_joins(const MapGraph& map, const PlaceIndex& places,
                                         const std::vector<KeyframeId>& keyframes,
                                         const std::function<bool(KeyframeId)>& is_in_map, const LoopOptions& options);

// Last step of a mapping run: searches loops from all new keyframes, corrects and bundle-adjusts the map around them,
// and removes weak points and redundant keyframes there. Corrects the whole map if a loop still disagrees.
FinishReport finish_map(MapGraph& online, const PlaceIndex& places, const FinishOptions& options,
                        const FinishHooks& hooks);

}  // namespace byre
