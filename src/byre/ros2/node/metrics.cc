#include "byre/ros2/node/metrics.h"

#include <fmt/core.h>

namespace byre {
namespace {

std::string metric(const char* name, const char* type, const char* help, double value) {
  return fmt::format("# HELP {} {}\n# TYPE {} {}\n{} {:.9g}\n", name, help, name, type, name, value);
}

}  // namespace

std::string metrics_text(const NodeCounters& counters) {
  std::string text = metric("byre_images_total", "counter", "Received left images", counters.images) +
                     metric("byre_images_left_out_total", "counter",
                            "Left images replaced by newer ones before tracking", counters.skipped) +
                     metric("byre_frames_total", "counter", "Frames passed to tracking", counters.frames);
  if (!counters.last) return text;
  const FrameReport& report = *counters.last;
  const Health& health = report.health;
  text += metric("byre_verdict", "gauge", "0 trusted, 1 degraded, 2 untrusted", static_cast<int>(health.verdict));
  text += metric("byre_has_pose", "gauge", "1: the pose in the map is available", report.map_from_body ? 1 : 0);
  text += metric("byre_track_seconds", "gauge", "Tracking time of the last frame", report.track_seconds);
  text += metric("byre_frame_late", "gauge", "1: the last frame exceeded its deadline", report.is_late);
  text += metric("byre_online_points_left_out", "gauge",
                 "1: online points were limited in the last frame to meet the deadline", report.cuts.online_points);
  text += metric("byre_right_image_left_out", "gauge", "1: the last frame was tracked with its left image only",
                 report.cuts.right_image);
  text += metric("byre_offline_inliers", "gauge", "Inliers of the offline map", health.offline_inliers);
  text += metric("byre_online_inliers", "gauge", "Inliers of the online map", health.online_inliers);
  text += metric("byre_position_sigma_metres", "gauge", "Standard error of the position", health.position_sigma);
  return text;
}

}  // namespace byre
