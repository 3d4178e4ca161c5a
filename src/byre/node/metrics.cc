#include "byre/node/metrics.h"

#include <fmt/core.h>

namespace byre {
namespace {

std::string metric(const char* name, const char* type, const char* help, double value) {
  return fmt::format("# HELP {} {}\n# TYPE {} {}\n{} {:.9g}\n", name, help, name, type, name, value);
}

}  // namespace

std::string metrics_text(const NodeFigures& figures) {
  std::string text =
      metric("byre_images_total", "counter", "Left images that came", figures.images) +
      metric("byre_images_left_out_total", "counter", "Left images left out for newer ones", figures.left_out) +
      metric("byre_frames_total", "counter", "Frames handed to tracking", figures.frames);
  if (!figures.last) return text;
  const FrameReport& report = *figures.last;
  const Health& health = report.health;
  text += metric("byre_verdict", "gauge", "0 trusted, 1 degraded, 2 untrusted", static_cast<int>(health.verdict));
  text += metric("byre_has_pose", "gauge", "Whether the pose in the map is known", report.map_from_body ? 1 : 0);
  text += metric("byre_track_seconds", "gauge", "Time of tracking the last frame", report.track_seconds);
  text += metric("byre_frame_late", "gauge", "Whether the last frame took longer than its deadline", report.is_late);
  text += metric("byre_online_points_left_out", "gauge", "Whether few online points were looked for in the last frame",
                 report.cuts.online_points);
  text += metric("byre_right_image_left_out", "gauge", "Whether the last frame was tracked by its left image alone",
                 report.cuts.right_image);
  text += metric("byre_offline_inliers", "gauge", "Points of the kept map that agree with the pose",
                 health.offline_inliers);
  text += metric("byre_online_inliers", "gauge", "Points mapped now that agree with the pose", health.online_inliers);
  text += metric("byre_position_sigma_metres", "gauge", "Standard error of the position", health.position_sigma);
  return text;
}

}  // namespace byre
