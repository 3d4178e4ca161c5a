#pragma once

#include "byre/body_motion.h"
#include "byre/map/map_view.h"

#include <optional>
#include <vector>

namespace byre {

// What a feature of a window's keyframe sees, in place of an index into MapWindow::points.
inline constexpr int kNoPoint = -1;
inline constexpr int kPointElsewhere = -2;  // a point outside the window

struct WindowKeyframe {
  KeyframeId id;                      // an offline keyframe is always an anchor
  Keyframe keyframe;                  // without words; which points its sightings see is told by point_of_feature
  std::vector<int> point_of_feature;  // index into MapWindow::points, kNoPoint or kPointElsewhere
  bool movable = false;               // whether mapping may move it; an anchor sees the same points and stays put
  bool is_new = false;                // mapping has not worked on it yet
  bool removed = false;
};

struct WindowObservation {
  int keyframe = 0;  // index into MapWindow::keyframes
  int feature = 0;
};

struct WindowPoint {
  std::optional<PointId> id;  // empty for one made in this window; one that is offline stays as it is
  MapPoint point;
  std::vector<WindowObservation> observations;
  int observations_elsewhere = 0;  // by keyframes outside the window
  bool removed = false;
  int foreign_views_elsewhere = 0;  // by offline keyframes outside the window, of an online point
};

// How the body moved between two keyframes by what else than the cameras tells it, in the map's lengths.
struct WindowMotion {
  int earlier = 0;  // indices into MapWindow::keyframes
  int later = 0;
  BodyMotion motion;
};

// A bounded copy of the maps around the newest keyframes: all that mapping may read.
struct MapWindow {
  std::vector<Rig> rigs;                  // the online map's, then the offline one's
  std::vector<WindowKeyframe> keyframes;  // the newest first, then by shared points, then offline and online anchors
  std::vector<WindowPoint> points;
  std::vector<WindowMotion> motions;

  const Rig& rig_of(const WindowKeyframe& keyframe) const {
    return rigs[static_cast<std::size_t>(keyframe.keyframe.rig)];
  }
};

struct WindowOptions {
  int movable = 16;                // online keyframes
  int anchors = 16;                // online keyframes
  int offline_anchors = 8;         // offline keyframes
  int min_offline_sightings = 30;  // see fix_gauge
  // Sightings of offline points by the movable keyframes: so many hold the window better than online anchors, which may
  // have drifted and are left out then.
  int sightings_in_place_of_anchors = 200;
};

// The window of one or several new online keyframes (the newest is its centre). Keyframes that no longer exist are left
// out; empty keyframes when none does. Offline anchors are those that share most points with the new keyframes, and
// bring all of theirs along, for what is new may be one of them.
MapWindow cut_window(const MapView& map, const std::vector<KeyframeId>& new_keyframes, const WindowOptions& options);

// The window of just these online keyframes and the points they see, none of them movable. First in it come others,
// with what they see of these points. Precondition: all exist.
MapWindow window_of(const MapView& map, const std::vector<KeyframeId>& keyframes,
                    const std::vector<KeyframeId>& others = {});

// Many enough sightings of offline points tell where the world is. With fewer, the very first keyframe of the online
// map becomes an anchor, or, should a window with a few have no online anchor at all, its oldest keyframe.
void fix_gauge(MapWindow& window, int min_offline_sightings);

inline bool is_offline(const WindowKeyframe& keyframe) {
  return keyframe.id.origin == Origin::offline;
}
inline bool is_offline(const WindowPoint& point) {
  return point.id && point.id->origin == Origin::offline;
}

// The first of the other keyframes, in the window's order, hence the nearest: online ones, then offline ones.
std::vector<int> nearest_neighbours(const MapWindow& window, int keyframe, int online_count, int offline_count);

// How many offline points a keyframe of the window sees.
int count_offline_sightings(const MapWindow& window, const WindowKeyframe& keyframe);

// By an online keyframe, the first in the window; empty when there is none. A point's reference must be such a one.
std::optional<WindowObservation> first_online_observation(const MapWindow& window, const WindowPoint& point);

// Keeps both ends of an observation in step within a window. Precondition: keyframe and point are not both offline.
void add_observation(MapWindow& window, int point, const WindowObservation& observation, const Sighting& sighting);
void remove_observation(MapWindow& window, const WindowObservation& observation);
void remove_point(MapWindow& window, int point);

}  // namespace byre
