#pragma once

#include "byre/viewer/ground.h"
#include "byre/viewer/legend.h"
#include "byre/viewer/plan_picture.h"

#include <vector>

#include <Eigen/Geometry>

namespace byre {

// The ground as a plan picture shows it: x right, y up on it.
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

// Marks, and what they mean.
struct ExplainedMarks {
  std::vector<PictureMark> marks;
  std::vector<LegendEntry> legend;
};

// Keyframes, and the way from one to the next; a much longer one than usual is left out.
ExplainedMarks keyframe_marks(const MapScene& map, const PlanView& view);

// Ways through the building with the place where each starts. A way with verdicts has a line that tells them: solid
// where trusted, dashed where degraded, dotted where untrusted, and none where there was no pose.
ExplainedMarks path_marks(const std::vector<PlanPath>& paths, const PlanView& view);

LegendEntry verdict_entry(Verdict verdict);

ExplainedMarks camera_marks(const PlanCamera& camera, const PlanView& view);

}  // namespace byre
