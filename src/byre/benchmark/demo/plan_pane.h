#pragma once

#include "byre/benchmark/demo/findings.h"
#include "byre/playback/play.h"
#include "byre/viewer/ground.h"
#include "byre/viewer/picture.h"
#include "byre/viewer/plan_picture.h"
#include "byre/viewer/scene.h"

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

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

struct PlanLabel {
  Eigen::Vector2d at;  // middle of the baseline, metres
  std::string text;
};

// Place of the second visit. x and y on the floor plan, metres.
struct DemoPlace {
  Ground ground;  // with the image of the floor plan
  Eigen::AlignedBox2d shown;
  Eigen::AlignedBox2d unmapped;  // shaded
  std::vector<PlanLabel> labels;
  std::vector<MovedThing> moved;
};

// Part of the ground around the true path of an arm.
Eigen::AlignedBox2d ground_around(const std::vector<DemoMoment>& moments);

// The plan from above with moved things, the true path, its start, and positions in colours of their error, up to a
// time from the first frame.
Pane plan_pane(const DemoPlace& place, const DemoArm& arm, double until_s, int width);

// Legend entry.
struct PlanSign {
  std::vector<PictureMark> marks;  // around the origin, about 24 pixels wide
  std::string meaning;
};
std::vector<PlanSign> plan_signs();

// Signs side by side in rows.
Pane plan_legend(const std::vector<PlanSign>& signs, int width);

// A line of text. `at` is the position of its left end.
PictureText plain_text(const Eigen::Vector2d& at, const std::string& text, double size);

}  // namespace byre
