#pragma once

#include "byre/viewer/ground.h"
#include "byre/viewer/picture.h"
#include "byre/viewer/scene.h"

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace byre {

// A way through the building.
struct PlanPath {
  std::string name;  // name in the legend
  Trajectory map_from_body;
  std::vector<Verdict> verdicts;  // one for each pose, shown by colour and stroke; or none: one colour for the path
};

// A camera on the plan, as a wedge that opens where it looks.
struct PlanCamera {
  Pose map_from_camera;
  double field_of_view = 1.2;  // radians, across
};
PlanCamera plan_camera(const Pose& map_from_body, const Rig& rig);

// What the plan picture shows.
struct PlanScene {
  std::string title;
  Ground ground;
  MapScene map;
  std::vector<PlanPath> paths;
  std::optional<PlanCamera> camera;
};

// Heights above the ground, metres.
struct HeightBand {
  double low = 0.1;
  double high = 2.5;
};

struct PlanPictureOptions {
  int width = 1200;    // pixels: what the ground is fitted into
  int height = 900;    // pixels, the legend not counted
  HeightBand heights;  // points outside are left out where the ground is level, so that floor and ceiling do not smear
  bool keyframes = true;
  bool whole_legend = false;  // explains every sign there may be, so that pictures of one run are of one size
  // Part of the ground to show, metres; else that of what there is to see, see shown_ground.
  std::optional<Eigen::AlignedBox2d> shown;
};

// The ground that a scene takes up: its points but for the farthest, its paths, and the plan too unless that is several
// times as large.
Eigen::AlignedBox2d shown_ground(const PlanScene& scene, const HeightBand& heights);

// The map and ways through it from above, with legend and scale bar.
Picture plan_picture(const PlanScene& scene, const PlanPictureOptions& options = {});

}  // namespace byre
