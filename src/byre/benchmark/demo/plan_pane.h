#pragma once

#include "byre/benchmark/demo/findings.h"
#include "byre/viewer/ground.h"
#include "byre/viewer/picture.h"

#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace byre {

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
