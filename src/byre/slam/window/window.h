#pragma once

#include "byre/body_motion.h"
#include "byre/map/map_view.h"

#include <optional>
#include <vector>

namespace byre {

// Values of point_of_feature that are no index into MapWindow::points.
inline constexpr int kNoPoint = -1;
inline constexpr int kPointElsewhere = -2;  // a point outside the window

struct WindowKeyframe {
  KeyframeId id;                      // offline keyframes are anchors, except in window_of_both_maps()
  Keyframe keyframe;                  // without words; point_of_feature has the points of its sightings
  std::vector<int> point_of_feature;  // index into MapWindow::points, kNoPoint or kPointElsewhere
  bool movable = false;               // mapping may move it; an anchor sees the same points and is fixed
  bool is_new = false;                // not mapped yet
  bool removed = false;
};

struct WindowObservation {
  int keyframe = 0;  // index into MapWindow::keyframes
  int feature = 0;
};

struct WindowPoint {
  std::optional<PointId> id;  // empty for a point made in this window
  MapPoint point;
  std::vector<WindowObservation> observations;
  int observations_elsewhere = 0;  // by keyframes outside the window
  bool removed = false;
  int foreign_views_elsewhere = 0;  // by offline keyframes outside the window, of an online point
};

// Measured motion of the body between two keyframes, in the map's lengths.
struct WindowMotion {
  int earlier = 0;  // indices into MapWindow::keyframes
  int later = 0;
  BodyMotion motion;
  bool holds_scale = false;  // the map has been in the unit of measured motion since it began
};

// Bounded copy of the maps around the newest keyframes: the only input of mapping.
struct MapWindow {
  std::vector<Rig> rigs;                  // the online map's, then the offline one's
  std::vector<WindowKeyframe> keyframes;  // the newest first, then by shared points, then offline and online anchors
  std::vector<WindowPoint> points;
  std::vector<WindowMotion> motions;

  const WindowKeyframe& keyframe(int index) const { return keyframes[static_cast<std::size_t>(index)]; }
  WindowKeyframe& keyframe(int index) { return keyframes[static_cast<std::size_t>(index)]; }
  const WindowPoint& point(int index) const { return points[static_cast<std::size_t>(index)]; }
  WindowPoint& point(int index) { return points[static_cast<std::size_t>(index)]; }
  const Rig& rig_of(const WindowKeyframe& keyframe) const {
    return rigs[static_cast<std::size_t>(keyframe.keyframe.rig)];
  }
};

struct WindowOptions {
  int movable = 16;                // online keyframes
  int anchors = 16;                // online keyframes
  int offline_anchors = 8;         // offline keyframes
  int min_offline_sightings = 30;  // see fix_gauge
  // Sightings of offline points by the movable keyframes from which online anchors, which may have drifted, are left
  // out.
  int sightings_in_place_of_anchors = 200;
};

// Window of one or several new online keyframes, centred on the newest. Keyframes that no longer exist are left out; no
// keyframes if none exists. Offline anchors are those that share most points with the new keyframes, with all of their
// points, since new points may be duplicates of them.
MapWindow cut_window(const MapView& map, const std::vector<KeyframeId>& new_keyframes, const WindowOptions& options);

// Window of exactly these online keyframes and the points they see, none of them movable. others come first, with their
// observations of these points. Precondition: all exist.
MapWindow window_of(const MapView& map, const std::vector<KeyframeId>& keyframes,
                    const std::vector<KeyframeId>& others = {});

// Window of the whole online map, then the offline keyframes in its view, with all points of both. Offline data are
// evidence in this window: their keyframes are movable, and so are the offline points that these see.
MapWindow window_of_both_maps(const MapView& map);

// Fixes the gauge. Enough sightings of offline points do so by themselves. With fewer, the very first keyframe of the
// online map becomes an anchor; if a window with a few sightings has no online anchor at all, its oldest keyframe does.
void fix_gauge(MapWindow& window, int min_offline_sightings);

inline bool is_offline(const WindowKeyframe& keyframe) {
  return keyframe.id.origin == Origin::offline;
}
inline bool is_offline(const WindowPoint& point) {
  return point.id && point.id->origin == Origin::offline;
}

// The first other keyframes in the window's order, hence the nearest: online ones, then offline ones.
std::vector<int> nearest_neighbours(const MapWindow& window, int keyframe, int online_count, int offline_count);

int count_offline_sightings(const MapWindow& window, const WindowKeyframe& keyframe);

// An offline point is fixed unless a movable offline keyframe sees it.
bool is_fixed(const MapWindow& window, const WindowPoint& point);

// First observation by an online keyframe of the window; empty without one. A point's reference must be such an
// observation.
std::optional<WindowObservation> first_online_observation(const MapWindow& window, const WindowPoint& point);

// Updates both ends of an observation. Precondition: keyframe and point are not both offline.
void add_observation(MapWindow& window, int point, const WindowObservation& observation, const Sighting& sighting);
void remove_observation(MapWindow& window, const WindowObservation& observation);
void remove_point(MapWindow& window, int point);

}  // namespace byre
