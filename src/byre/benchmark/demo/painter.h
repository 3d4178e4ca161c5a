#pragma once

#include "byre/playback/map_run.h"
#include "byre/viewer/frame_view.h"
#include "byre/viewer/plan_picture.h"

#include <optional>
#include <string>

namespace byre {

// Collects the content of the two pictures from each frame of a mission. The camera picture shows the frame whose pose
// rests best on both offline and online points.
class DemoPainter {
 public:
  explicit DemoPainter(const Calibration& calibration) : view_(calibration) {}

  void add(const RunView& run);

  std::optional<double> camera_s() const;  // from the first frame; empty before the first pose

  // SVG pictures. background: the offline map. Precondition of camera_picture: camera_s() is not empty.
  std::string plan_picture(PlanScene background) const;
  std::string camera_picture() const;

 private:
  FrameView view_;
  std::optional<Timestamp> first_;
  PlanPath path_;    // published poses with verdicts
  MapScene online_;  // map after the last frame
  std::optional<FrameScene> best_;
  int best_points_ = -1;  // count of the rarer kind of points, offline or online, in best_; -1: none yet
};

}  // namespace byre
