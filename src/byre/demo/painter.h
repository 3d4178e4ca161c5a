#pragma once

#include "byre/playback/map_run.h"
#include "byre/viewer/frame_view.h"
#include "byre/viewer/plan_picture.h"

#include <optional>
#include <string>

namespace byre {

// Looks at each frame of a mission, and keeps of it what its two pictures show. The camera picture is of the frame in
// which old and new points hold the pose together best.
class DemoPainter {
 public:
  explicit DemoPainter(const Calibration& calibration) : view_(calibration) {}

  void look(const RunView& run);

  std::optional<double> camera_s() const;  // from the first frame; empty while no frame had a pose

  // Both as SVG. background: the map the mission ran on. Precondition of the second: camera_s is not empty.
  std::string plan_picture(PlanScene background) const;
  std::string camera_picture() const;

 private:
  FrameView view_;
  std::optional<Timestamp> first_;
  PlanPath way_;     // poses as published, with their verdicts
  MapScene online_;  // map after the last frame
  std::optional<FrameScene> best_;
  int best_points_ = -1;  // points of the rarer kind, offline or online, in the best frame; -1: there is none
};

}  // namespace byre
