#pragma once

#include "byre/map/map_view.h"

#include <optional>
#include <vector>

namespace byre {

// What a feature of a window's keyframe sees, in place of an index into MapWindow::points.
inline constexpr int kNoPoint = -1;
inline constexpr int kPointElsewhere = -2;  // a point outside the window

struct WindowKeyframe {
  KeyframeId id;
  Keyframe keyframe;                  // sightings' pixels hold; which point they see is told by point_of_feature
  std::vector<int> point_of_feature;  // index into MapWindow::points, kNoPoint or kPointElsewhere
  bool movable = false;               // else an anchor: it sees the same points and stays put
  bool is_new = false;                // mapping has not worked on it yet
  bool removed = false;
};

struct WindowObservation {
  int keyframe = 0;  // index into MapWindow::keyframes
  int feature = 0;
};

struct WindowPoint {
  std::optional<PointId> id;  // empty for one made in this window
  MapPoint point;
  std::vector<WindowObservation> observations;
  int observations_elsewhere = 0;  // by keyframes outside the window
  bool removed = false;
};

// A bounded copy of the map around its newest keyframes: all that mapping may read.
struct MapWindow {
  std::vector<Rig> rigs;
  std::vector<WindowKeyframe> keyframes;  // the newest first, then by shared points, anchors last
  std::vector<WindowPoint> points;

  const Rig& rig_of(const WindowKeyframe& keyframe) const {
    return rigs[static_cast<std::size_t>(keyframe.keyframe.rig)];
  }
};

struct WindowOptions {
  int movable = 16;  // keyframes
  int anchors = 16;
};

// The window of one or several new keyframes (the newest is its centre). Keyframes that no longer exist are left out;
// empty keyframes when none does. The very first keyframe of a map is never movable: it holds the world in place.
MapWindow cut_window(const Map& map, const std::vector<KeyframeId>& new_keyframes, const WindowOptions& options);

// The window of just these keyframes and the points they see, none of them movable. Precondition: all exist.
MapWindow window_of(const Map& map, const std::vector<KeyframeId>& keyframes);

// Keeps both ends of an observation in step within a window.
void add_observation(MapWindow& window, int point, const WindowObservation& observation, const Sighting& sighting);
void remove_observation(MapWindow& window, const WindowObservation& observation);
void remove_point(MapWindow& window, int point);

}  // namespace byre
