#pragma once

#include "byre/slam/delta.h"
#include "byre/slam/loop_closing.h"
#include "byre/slam/mapping.h"

#include <functional>
#include <map>
#include <vector>

namespace byre {

struct GlobalMappingOptions {
  MappingOptions mapping;
  int first_bundle_iterations = 8;  // before outliers are taken out
};

// By what the lengths around keyframes have grown, those of removed ones too: after over before. Those not named keep
// theirs.
using LengthChanges = std::map<KeyframeId, double>;

// Whether the lengths around some keyframes are told by nothing but the map itself: they have no stereo, and no offline
// map is in view.
bool scale_may_drift(const MapWindow& window);

// A copy of a whole online map, all of it movable but what holds the world in place, with the offline points it sees.
MapWindow whole_map(const MapView& map);

// Bends the map so that loops close: a pose graph over covisibility and loops moves the keyframes, and their points
// along; points on both sides of a loop are fused; bundle adjustment of everything settles the rest. Without loops the
// last alone. Before all that, parts that share no points go to where wheels have them by now. Keyframes without stereo
// move as similarities (Strasdat 2010, Scale drift-aware large scale monocular SLAM): the scale of what they map has
// drifted, and lengths around them change. should_stop, unless empty, is asked now and then: what was reached by then
// is the result.
MapDelta adjust_map(const MapWindow& whole, const std::vector<LoopEdge>& loops, const GlobalMappingOptions& options,
                    const std::function<bool()>& should_stop = {});

// The same with a copy that is used up. before: the copy, or its outline.
MapDelta adjust_map(MapWindow&& window, const MapWindow& before, const std::vector<LoopEdge>& loops,
                    const GlobalMappingOptions& options, const std::function<bool()>& should_stop = {});

// The same to the copy itself.
void adjust_window(MapWindow& window, const std::vector<LoopEdge>& loops, const GlobalMappingOptions& options,
                   const std::function<bool()>& should_stop = {});

// The same to a map that nobody changes in the meantime, of which the window is a copy: without a second one. What it
// returns is as of apply_correction.
LengthChanges adjust_at_once(MapWindow window, const std::vector<LoopEdge>& loops, const GlobalMappingOptions& options,
                             Map& online, const std::function<bool()>& should_stop = {});

// Applies what was found for a map as it was (before, of which the outline will do) to the map as it is now. Keyframes
// and points that came in the meantime go along with those they hang from; what moved in the meantime keeps its motion.
// Returns the changes of length by which whatever lies relative to a keyframe, such as a frame, is to follow; with
// stereo there are none.
LengthChanges apply_correction(const MapDelta& correction, const MapWindow& before, Map& online);

// A loop as it was measured, in the lengths that there are since.
LoopEdge in_new_lengths(const LoopEdge& loop, const LengthChanges& changes);

}  // namespace byre
