#pragma once

#include "byre/viewer/ground.h"
#include "byre/viewer/palette.h"
#include "byre/viewer/picture.h"
#include "byre/viewer/scene.h"

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace byre {

// Path through the building.
struct PlanPath {
  std::string name;
  Trajectory map_from_body;
  std::vector<Verdict> verdicts;  // one per pose, drawn as colour and stroke; empty: one colour for the path
};

// Camera on the plan, drawn as a wedge in viewing direction.
struct PlanCamera {
  Pose map_from_camera;
  double field_of_view = 1.2;  // horizontal, radians
};
PlanCamera plan_camera(const Pose& map_from_body, const Rig& rig);

// How points of one origin are drawn.
struct PointStyle {
  std::string meaning;
  Colour colour;
};

// Content of a plan picture.
struct PlanScene {
  std::string title;
  Ground ground;
  MapScene map;
  std::vector<PlanPath> paths;
  std::optional<PlanCamera> camera;
  PointStyle offline{"offline map", palette::kOffline};
  PointStyle online{"online map", palette::kOnline};

  const PointStyle& style_of(Origin origin) const { return origin == Origin::offline ? offline : online; }
};

// Heights above the ground, metres.
struct HeightBand {
  double low = 0.1;
  double high = 2.5;
};

struct PlanPictureOptions {
  int width = 1200;    // pixels, of the area that the ground is fitted into
  int height = 900;    // pixels, without the legend
  HeightBand heights;  // hides points outside on level ground, such as floor and ceiling
  bool keyframes = true;
  bool whole_legend = false;  // lists all symbols, for pictures of equal size
  // Part of the ground to show, metres; empty: see shown_ground.
  std::optional<Eigen::AlignedBox2d> shown;
};

// Extent of a scene on the ground: points without outliers, paths, and the plan unless it is several times larger.
Eigen::AlignedBox2d shown_ground(const PlanScene& scene, const HeightBand& heights);

// Map and paths from above, with legend and scale bar.
Picture plan_picture(const PlanScene& scene, const PlanPictureOptions& options = {});

}  // namespace byre
