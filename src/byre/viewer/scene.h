#pragma once

#include "byre/calibration.h"
#include "byre/image.h"
#include "byre/map.h"
#include "byre/map/map_view.h"
#include "byre/slam/session/session.h"

#include <memory>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Values to draw, copied from a session so that viewers hold no reference to it. Metres in the map frame.

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

// Points and keyframes of both maps: offline first, each in order of ids.
MapScene scene_of(const MapView& map);

// Points of a map that a later version lacks, as offline points, and those that it added, as online points.
MapScene scene_of(const Map& before, const Map& after, const MapDifference& difference);

// Frame of a run to draw.
struct FrameScene {
  FrameReport report;
  Image left;                   // rectified; the frame of `seen`
  std::vector<SeenPoint> seen;  // matched map points
};

// Rectifies left images with the calibration used for features, so that features match the images. Call it from one
// thread.
class FrameView {
 public:
  // Throws InputError if the calibration cannot be rectified.
  explicit FrameView(const Calibration& calibration);
  ~FrameView();

  const Rig& rig() const;

  // Precondition: the image has the calibrated size.
  FrameScene scene_of(const Image& left, const FrameReport& report, const std::vector<SeenPoint>& seen) const;

 private:
  struct State;                   // hides OpenCV
  std::unique_ptr<State> state_;  // constant after construction
};

}  // namespace byre
