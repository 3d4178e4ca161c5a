#include "byre/playback/report/report.h"
#include "byre/playback/report/run_report.h"

#include <cmath>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

Json milliseconds_json(const PlayedFrame& frame) {
  const StageSeconds& seconds = frame.seconds;
  Json json;
  const auto add = [&json](const char* name, double value) { json[name] = rounded_ms(1e3 * value); };
  add("decode", seconds.decode);
  add("rectify", seconds.rectify);
  add("extract", seconds.extract);
  add("stereo", seconds.stereo);
  add("track", seconds.track);
  add("map", seconds.map);
  add("map_submit", seconds.map_submit);
  add("total", seconds.total);
  const std::optional<double> job = frame.report->job_seconds;
  json["job_taken_over"] = job ? Json(rounded_ms(1e3 * *job)) : Json();
  return json;
}

Json frame_json(const PlayedFrame& frame, const PoseError* error) {
  Json json = {{"time_s", to_seconds(frame.time)}, {"time_ns", frame.time.count()}};
  if (!frame.report) {
    json["state"] = "unreadable";
    return json;
  }
  const FrameReport& report = *frame.report;
  json["state"] = to_string(report.state);
  json["map_keyframes"] = frame.keyframes;
  json["map_points"] = frame.points;
  json["memory_mb"] = std::round(10.0 * frame.memory_mb) / 10.0;
  json["relocalised"] = report.has(SessionEvent::relocalised);
  json["loop_found"] = report.has(SessionEvent::loop_found);
  json["map_corrected"] = report.has(SessionEvent::map_corrected);
  json["has_right_image"] = frame.has_right;
  json["has_depth_image"] = frame.has_depth;
  json["online_points_left_out"] = report.cuts.online_points;
  json["right_image_left_out"] = report.cuts.right_image;
  json["keyframe"] = report.keyframe_added;
  json["features"] = report.features;
  json["expected"] = report.expected_points;
  json["matches"] = report.matches;
  json["inliers"] = report.inliers;
  if (!report.map.empty()) json["map"] = report.map;
  if (report.map_from_body) json.update(pose_json(*report.map_from_body, report.covariance));
  if (report.odometry_from_body) json["odometry"] = pose_json(*report.odometry_from_body, report.odometry_covariance);
  json["health"] = health_json(report.health);
  if (error != nullptr) json["error"] = {{"position_m", error->position()}, {"rotation_deg", error->rotation()}};
  json["ms"] = milliseconds_json(frame);
  return json;
}

}  // namespace

std::string to_json(const Report& report, const RunResult& run, const std::optional<MissionOutcome>& mission) {
  std::string text = to_json(report);
  text.erase(text.rfind("\n}"));
  text += ",\n  \"frames\": [";
  const char* separator = "\n    ";
  for (const PlayedFrame& frame : run.frames) {
    const bool has_truth = mission && mission->errors;
    const PoseError* const error = has_truth ? find_error(mission->errors->causal, frame.time) : nullptr;
    text += separator + dump_json(frame_json(frame, error));
    separator = ",\n    ";
  }
  return text + "\n  ]\n}\n";
}

}  // namespace byre
