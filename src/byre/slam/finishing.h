#pragma once

#include "byre/slam/global_mapping.h"
#include "byre/slam/loop_closing.h"
#include "byre/slam/told_motions.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace byre {

struct FinishOptions {
  LoopOptions loops;
  GlobalMappingOptions global;
  std::vector<KeyframeMotion> motions;  // see told_motions
  PlaceNoise noise;                     // noise put on the places that the search for loops is given
  // Number of the first keyframe that came since the map was finished before: what lies far from all that came stays as
  // it is, see recent_map. 0: all of the map came.
  std::uint32_t first_new = 0;
};

// How sound a map is by what can be known without any truth.
struct MapQuality {
  int keyframes = 0;
  int points = 0;
  int observations = 0;
  double reprojection_median = 0.0;  // pixels
  double reprojection_p95 = 0.0;     // pixels
  int parts = 0;                     // groups of keyframes that no shared point connects
};

struct FinishReport {
  int loops = 0;                       // places found again that the map did not know of
  std::vector<double> loop_drifts;     // pixels by which both sides of a loop had drifted apart, see apparent_drift
  std::vector<double> loop_residuals;  // metres by which a loop still disagrees with what was seen
  int keyframes_removed = 0;           // keyframes found redundant
  int points_removed = 0;              // points found weak
  LengthChanges length_changes;        // growth that what lies relative to a keyframe must follow, see apply_correction
  MapQuality before;
  MapQuality after;
};

struct FinishHooks {
  std::function<bool()> should_stop;                  // asked now and then; what was reached by then is kept
  std::function<void(const char* step)> before_step;  // "looking for loops", ...
};

MapQuality quality_of(const Map& map);

// Places that keyframes that came went back to without the map knowing it, each confirmed by the keyframes around. From
// the newest keyframe backwards; those around one that has found a loop are not asked again.
std::vector<LoopHypothesis> search_loops(const Map& map, const PlaceIndex& places, const FinishOptions& options,
                                         const FinishHooks& hooks);

// What a mapping run ends with: a last search for loops from all keyframes that came, correction and bundle adjustment
// of what lies around these, removal of weak points and redundant keyframes there. Where a loop disagrees after that,
// all of the map is corrected.
FinishReport finish_map(Map& online, const PlaceIndex& places, const FinishOptions& options, const FinishHooks& hooks);

}  // namespace byre
