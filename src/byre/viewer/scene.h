#pragma once

#include "byre/image.h"
#include "byre/map/map_view.h"
#include "byre/session/session.h"

#include <vector>

#include <Eigen/Core>

namespace byre {

// What pictures and viewers show, as copied values: whoever draws never holds on to a session or its map. Lengths are
// metres in the map's frame.

struct ScenePoint {
  Eigen::Vector3f position_in_map;
  Origin origin = Origin::online;
};

struct SceneKeyframe {
  Timestamp time{};
  Pose map_from_body;
  Origin origin = Origin::online;
};

struct MapScene {
  std::vector<ScenePoint> points;
  std::vector<SceneKeyframe> keyframes;
};

// Both maps, the offline one first, each in the order of its ids.
MapScene scene_of(const MapView& map);

// One frame of a run.
struct FrameScene {
  FrameReport report;
  Image left;                   // rectified: seen points lie in it
  std::vector<SeenPoint> seen;  // map points matched in it
};

}  // namespace byre
