#pragma once

#include "byre/slam/loops/loop_closing.h"
#include "byre/slam/tracking/deferred_refinement.h"
#include "byre/slam/window/delta.h"
#include "byre/slam/window/mapping.h"
#include "byre/slam/window/window.h"

#include <functional>
#include <map>
#include <vector>

namespace byre {

struct GlobalMappingOptions {
  MappingOptions mapping;
  int first_bundle_iterations = 8;  // iterations before outlier removal
};

// Scale changes around keyframes, removed ones included: length after over length before. Others are unchanged.
using LengthChanges = std::map<KeyframeId, double>;

// Whether only the map itself determines the scale around some keyframes: no stereo, no offline map in view, and no
// motion that holds the scale.
bool scale_may_drift(const MapWindow& window);

// Copy of a whole online map and the offline points that it sees. All keyframes but the gauge are movable.
MapWindow whole_map(const MapView& map);

// Same, followed by the offline keyframes in view, which move as well, see window_of_both_maps(). Without them if the
// online map hardly sees the offline one.
MapWindow both_maps(const MapView& map);

// Removes the offline keyframes from an adjusted copy of both maps and from the copy before. Returns their poses and
// points. The frame of the offline map is kept: everything moves such that the offline points fit their earlier
// positions.
AdjustedOffline detach_offline(MapWindow& adjusted, MapWindow& before);

// Closes loops: a pose graph over covisibility and loops moves the keyframes with their points, points on both sides of
// a loop are fused, and bundle adjustment refines everything. Without loops, bundle adjustment alone. First, parts that
// share no points are placed by measured motion. Keyframes without stereo move as similarities (Strasdat 2010, Scale
// drift-aware large scale monocular SLAM), since their scale has drifted; lengths around them change. should_stop,
// unless empty, is polled and ends with the present result. window: copy of the map, see whole_map. before: the same
// copy unchanged, or its outline.
MapDelta adjust_map(MapWindow&& window, const MapWindow& before, const std::vector<LoopEdge>& loops,
                    const GlobalMappingOptions& options, const std::function<bool()>& should_stop = {});

// Same, on the copy itself.
void adjust_window(MapWindow& window, const std::vector<LoopEdge>& loops, const GlobalMappingOptions& options,
                   const std::function<bool()>& should_stop = {});

// Same, on a map that does not change meanwhile and of which the window is a copy; makes no second copy. Returns the
// result of apply_correction.
LengthChanges adjust_at_once(MapWindow window, const std::vector<LoopEdge>& loops, const GlobalMappingOptions& options,
                             MapGraph& online, const std::function<bool()>& should_stop = {});

// Applies a correction of an earlier state of the map (before, or its outline) to the present map. Keyframes and points
// added since move with the keyframes that they depend on; motion since then is kept. Returns the scale changes that
// poses relative to keyframes must follow, such as those of frames; none with stereo.
LengthChanges apply_correction(const MapDelta& correction, const MapWindow& before, MapGraph& online);

// A measured loop in the present lengths of the map.
LoopEdge in_new_lengths(const LoopEdge& loop, const LengthChanges& changes);

// Places parts of the window that share no points by the measured motion between them, which may be more precise now
// than at their beginning. Each part moves, with its points, to the pose predicted from the part before. Monocular
// parts and the motions are scaled to the first part. Fixed keyframes do not move, nor parts that share points with
// them or with the oldest keyframe that has a motion. False, and nothing changes, if no motion connects two parts.
bool place_parts(MapWindow& window);

}  // namespace byre
