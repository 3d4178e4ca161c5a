#pragma once

#include "byre/cli/formatted.h"
#include "byre/map/floor_plan_scene.h"
#include "byre/map/map_file.h"

#include <string>

namespace byre::cli {

// The driven barn as a map to keep.
inline StoredMap driven_barn(FloorPlanScene& scene) {
  const Camera camera{CameraModel::pinhole, 320, 240, 188.0, 188.0, 158.0, 119.0, {}};
  StoredMap stored;
  stored.map = scene.driven_map(scene.path_in_map());
  stored.recordings = {{"barn_morning", {camera, std::nullopt, {}}, {}, std::chrono::seconds(100)}};
  return stored;
}

// The picks as a file has them.
inline std::string picks_csv(const std::vector<PlanCorrespondence>& correspondences) {
  std::string text = "#point_x_m,point_y_m,point_z_m,plan_x_m,plan_y_m,name\n";
  for (const PlanCorrespondence& each : correspondences) {
    text += formatted("%.9f,%.9f,%.9f,", each.point_in_map.x(), each.point_in_map.y(), each.point_in_map.z());
    text += formatted("%.9f,%.9f,", each.point_in_plan.x(), each.point_in_plan.y()) + each.name + "\n";
  }
  return text;
}

// A PGM image, white all over.
inline std::string plan_image(int width, int height) {
  return formatted("P5\n%d %d\n255\n", width, height) + std::string(static_cast<std::size_t>(width * height), '\xff');
}

}  // namespace byre::cli
