#pragma once

#include "byre/viewer/ground.h"
#include "byre/viewer/legend.h"
#include "byre/viewer/plan_picture.h"

#include <vector>

#include <Eigen/Geometry>

namespace byre {

// Projection of the ground to pixels: x right, y up.
struct PlanView {
  Eigen::AlignedBox2d shown;  // metres
  double pixels_per_metre = 1.0;
  Similarity ground_from_map;

  Eigen::Vector2d pixel(const Eigen::Vector2d& on_ground) const {
    return pixels_per_metre * Eigen::Vector2d(on_ground.x() - shown.min().x(), shown.max().y() - on_ground.y());
  }
  Eigen::Vector2d pixel_of(const Eigen::Vector3d& point_in_map) const {
    return pixel((ground_from_map * point_in_map).head<2>());
  }
};

// Image of the ground's plan, faded. Precondition: the ground has an image.
PictureImage ground_image(const Ground& ground, const PlanView& view);

// Marks with their legend.
struct MarksWithLegend {
  std::vector<PictureMark> marks;
  std::vector<LegendEntry> legend;
};

// Keyframes, joined by lines; unusually long gaps are left open.
MarksWithLegend keyframe_marks(const MapScene& map, const PlanView& view);

// Paths with their starts. Verdicts are drawn as strokes: solid for trusted, dashed for degraded, dotted for untrusted;
// no line without a pose.
MarksWithLegend path_marks(const std::vector<PlanPath>& paths, const PlanView& view);

LegendEntry verdict_entry(Verdict verdict);

MarksWithLegend camera_marks(const PlanCamera& camera, const PlanView& view);

}  // namespace byre
