#pragma once

#include "byre/playback/play.h"
#include "byre/viewer/frame_view.h"
#include "byre/viewer/plan_picture.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// Collects the content of pictures from each frame of a mission. The camera picture shows the frame whose pose rests
// best on both offline and online points.
class DemoPainter {
 public:
  // every_for_film: one of so many frames is kept for an animation; 0: none.
  DemoPainter(const Calibration& calibration, int every_for_film)
      : view_(calibration), every_for_film_(every_for_film) {}

  void add(const RunView& run);

  std::optional<double> camera_s() const;  // from the first frame; empty before the first pose

  // SVG pictures. background: the offline map. Precondition of camera_picture: camera_s() is not empty.
  std::string plan_picture(PlanScene background) const;
  std::string camera_picture() const;

  const std::vector<FrameScene>& film() const { return film_; }

 private:
  FrameView view_;
  int every_for_film_;
  int frames_ = 0;
  std::vector<FrameScene> film_;
  std::optional<Timestamp> first_;
  PlanPath path_;    // published poses with verdicts
  MapScene online_;  // map after the last frame
  std::optional<FrameScene> best_;
  int best_points_ = -1;  // count of the rarer kind of points, offline or online, in best_; -1: none yet
};

}  // namespace byre
