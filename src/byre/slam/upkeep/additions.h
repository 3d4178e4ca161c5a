#pragma once

#include "byre/map/map_view.h"

#include <vector>

namespace byre {

// Online keyframes of a mission to add to a map, ascending: those with a new view, or at places where the mission saw
// few of the map's points. New places only while the drift since the mission left the map is below 5 cm (one sigma). At
// most a few at each place, and none near additions of another mission, which may disagree by their drift. Only
// keyframes that points connect to the map; others may be of a part that was never located in it. child: the map with
// additions of other missions.
std::vector<KeyframeId> keyframes_to_add(const MapGraph& map, const MapGraph& child, const MapGraph& online);

struct Added {
  int keyframes = 0;
  int points = 0;
};

// Adds these keyframes with the points that they define and at least three keyframes of the mission saw. What the map
// contains does not change. recording: of the new keyframes.
Added add_keyframes(const MapGraph& online, const std::vector<KeyframeId>& keyframes, int recording, MapGraph& map);

}  // namespace byre
