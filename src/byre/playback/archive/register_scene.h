#pragma once

#include "byre/map/map_file.h"
#include "byre/map/plan/floor_plan_scene.h"

#include <string>

#include <fmt/core.h>

namespace byre {

inline StoredMap driven_barn(FloorPlanScene& scene) {
  const Camera camera{CameraModel::pinhole, 320, 240, 188.0, 188.0, 158.0, 119.0, {}};
  StoredMap stored;
  stored.map = scene.driven_map(scene.path_in_map());
  const StereoPartner right{camera, {Eigen::Quaterniond::Identity(), {-stored.map.rigs()[0].baseline, 0.0, 0.0}}};
  stored.recordings = {{"barn_morning", {camera, right, {}}, {}, std::chrono::seconds(100)}};
  return stored;
}

inline std::string picks_csv(const std::vector<PlanCorrespondence>& correspondences) {
  std::string text = "#point_x_m,point_y_m,point_z_m,plan_x_m,plan_y_m,name\n";
  for (const PlanCorrespondence& each : correspondences) {
    text += fmt::format("{:.9f},{:.9f},{:.9f},", each.point_in_map.x(), each.point_in_map.y(), each.point_in_map.z());
    text += fmt::format("{:.9f},{:.9f},", each.point_in_plan.x(), each.point_in_plan.y()) + each.name + "\n";
  }
  return text;
}

// Body positions at every tenth keyframe of the driven barn as picks by time.
inline std::string keyframe_picks_csv(const FloorPlanScene& scene, const StoredMap& stored) {
  std::string text = "time_s,plan_x_m,plan_y_m\n";
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    if (id.number % 10 != 5) continue;
    const Keyframe& keyframe = *stored.map.find_keyframe(id);
    const Eigen::Vector3d in_plan = scene.plan_from_map * body_at(stored.map, keyframe);
    text += fmt::format("{:.9f},{:.9f},{:.9f}\n", to_seconds(keyframe.frame.time), in_plan.x(), in_plan.y());
  }
  return text;
}

// A white PGM image.
inline std::string plan_image(int width, int height) {
  return fmt::format("P5\n{} {}\n255\n", width, height) + std::string(static_cast<std::size_t>(width * height), '\xff');
}

}  // namespace byre
