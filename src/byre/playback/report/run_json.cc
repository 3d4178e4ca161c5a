#include "byre/playback/report/calibration_report.h"
#include "byre/playback/report/finish_report.h"
#include "byre/playback/report/map_statistics.h"
#include "byre/playback/report/recording_check_report.h"
#include "byre/playback/report/report_json.h"
#include "byre/playback/report/run_report.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMillisecondsPerSecond = 1e3;
constexpr std::size_t kListedWarnings = 20;
constexpr const char* kCovariance =
    "6x6, row-major, of a small motion (translation in metres, rotation vector in radians) in the body frame, relative "
    "to the map's origin";

// Rounded to microseconds; further digits are noise.
double rounded_ms(double milliseconds) {
  return std::round(1e3 * milliseconds) / 1e3;
}

template <typename Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

// Options that determine the computational load, and all changed from their defaults.
Json options_json(const MethodOptions& options) {
  Json changed = Json::object();
  for (const auto& [name, value] : changed_options(options)) changed[name] = value;
  return {{"max_features", options.extract.max_features},
          {"fast_threshold", options.extract.fast_threshold},
          {"min_fast_threshold", options.extract.min_fast_threshold},
          {"min_initial_points", options.session.min_initial_points},
          {"local_keyframes", options.session.local_keyframes},
          {"movable_keyframes", options.session.window.movable},
          {"anchor_keyframes", options.session.window.anchors},
          {"loops", options.close_loops},
          {"changed", changed}};
}

Json protocol_json(const MapProtocol& protocol) {
  const FrameRange& range = protocol.range;
  Json json = {{"program", protocol.program},
               {"version", BYRE_VERSION},
               {"recording", protocol.recording},
               {"format", protocol.format ? to_string(*protocol.format) : "live"},
               {"camera", to_string(protocol.camera)},
               {"scale", protocol.is_metric ? "metric" : "unknown"},
               {"range",
                {{"start_s", or_null(range.start_s)},
                 {"end_s", or_null(range.end_s)},
                 {"first_frame", range.first},
                 {"end_frame", or_null(range.last)},
                 {"stride_frames", range.stride}}},
               {"frames_in_range", protocol.frames_in_range},
               {"times", times_json(protocol.times)},
               {"pace", name_of(protocol.options.pace)}};
  if (protocol.options.pace == Pace::paced) {
    json["mapping_latency_frames"] = kPacedLatency;
    if (protocol.offline.empty()) {
      json["correction_latency_frames"] = kPacedCorrectionLatency;
    } else {
      json["search_latency_frames"] = kPacedSearchLatency;
    }
  }
  if (!protocol.extended.empty()) json["extended"] = protocol.extended;
  if (!protocol.offline.empty()) {
    json["offline_map"] = protocol.offline;
    json["pose_frame"] = protocol.plan ? "plan" : "map";
    if (protocol.plan) json["registration"] = registration_json(*protocol.plan);
    json["localise_only"] = !protocol.options.session.map_online;
    json["offline_weight"] = protocol.options.session.track.offline_weight;
  }
  json["options"] = options_json(protocol.options);
  json["body_covariance"] = kCovariance;
  return json;
}

Json refused_starts_json(const FrameCounts& counts) {
  Json json = Json::object();
  for (const auto& [failure, frames] : counts.refused_starts) json[std::string(to_string(failure))] = frames;
  return json;
}

Json counts_json(const MapRun& run) {
  const FrameCounts counts = count_frames(run.frames);
  return {{"frames", counts.frames},
          {"frames_with_pose", counts.with_pose},
          {"coverage", counts.coverage()},
          {"frames_unreadable", counts.unreadable},
          {"frames_without_right_image", counts.without_right_image},
          {"frames_with_depth_image", counts.with_depth_image},
          {"keyframes_made", counts.keyframes},
          {"keyframes_left", run.stored.map.keyframe_count()},
          {"points", run.stored.map.point_count()},
          {"frames_before_the_first_pose", or_null(counts.frames_to_first)},
          {"refused_starts", refused_starts_json(counts)},
          {"lost_episodes", counts.lost_episodes},
          {"frames_lost", counts.lost},
          {"resets", counts.resets},
          {"relocalisations", counts.relocalisations},
          {"loops_on_the_way", counts.loops},
          {"corrections_on_the_way", counts.corrections}};
}

// Keyframes per recording, and frames until the new recording was localised in the map; null unless a map is extended.
Json extension_json(const MapRun& run, const MapProtocol& protocol) {
  if (protocol.extended.empty()) return nullptr;
  const std::vector<int> keyframes = keyframes_of_recordings(run.stored.map, protocol.recordings.size());
  Json recordings = Json::array();
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    recordings.push_back({{"name", protocol.recordings[i]}, {"keyframes", keyframes[i]}});
  }
  return {{"frames_until_found", or_null(count_frames(run.frames).frames_to_first)}, {"recordings", recordings}};
}

Json to_json(const TimeSummary& times) {
  if (times.count == 0) return nullptr;
  return {{"mean", rounded_ms(times.mean_ms)},
          {"p50", rounded_ms(times.p50_ms)},
          {"p95", rounded_ms(times.p95_ms)},
          {"p99", rounded_ms(times.p99_ms)},
          {"max", rounded_ms(times.max_ms)}};
}

Json stages_json(const std::vector<MappedFrame>& frames) {
  const auto stage = [&frames](double StageSeconds::*member) { return to_json(summarise_stage(frames, member)); };
  return {{"decode", stage(&StageSeconds::decode)},   {"rectify", stage(&StageSeconds::rectify)},
          {"extract", stage(&StageSeconds::extract)}, {"stereo", stage(&StageSeconds::stereo)},
          {"track", stage(&StageSeconds::track)},     {"map", stage(&StageSeconds::map)}};
}

Json jobs_json(const std::vector<double>& job_seconds) {
  const TimeSummary jobs = summarise_times(job_seconds);
  return {{"count", jobs.count}, {"mean_ms", rounded_ms(jobs.mean_ms)}, {"max_ms", rounded_ms(jobs.max_ms)}};
}

Json late_json(const MapRun& run) {
  const TimeSummary late = summarise_times(run.lateness);
  return {{"frames", late.count}, {"max_ms", rounded_ms(late.max_ms)}};
}

Json deadline_json(const MapRun& run, double deadline_ms) {
  if (deadline_ms <= 0.0) return nullptr;
  const FrameCounts counts = count_frames(run.frames);
  return {{"deadline_ms", deadline_ms},
          {"frames_late", counts.late},
          {"frames_without_online_points", counts.without_online_points},
          {"frames_with_left_image_alone", counts.with_left_alone}};
}

Json warnings_json(const std::vector<std::string>& warnings) {
  const auto listed = static_cast<std::ptrdiff_t>(std::min(warnings.size(), kListedWarnings));
  return {{"count", warnings.size()}, {"first", std::vector(warnings.begin(), warnings.begin() + listed)}};
}

Json run_json(const MapRun& run, const MapProtocol& protocol, const ResourceUsage& resources,
              const std::optional<MissionOutcome>& mission) {
  const Pace pace = protocol.options.pace;
  Json json = {{"protocol", protocol_json(protocol)},
               {"stopped_early", static_cast<int>(run.frames.size()) < protocol.frames_in_range},
               {"counts", counts_json(run)},
               {"extension", extension_json(run, protocol)},
               {"calibration", run.calibration ? calibration_json(*run.calibration) : Json()},
               {"calibration_row_error_px", run.row_error ? Json(*run.row_error) : Json()},
               {"finishing", run.finishing ? byre::to_json(*run.finishing) : Json()},
               {"frame_thread_ms", to_json(summarise_stage(run.frames, &StageSeconds::total))},
               {"stages_ms", stages_json(run.frames)},
               {"deadline", deadline_json(run, protocol.options.frame_deadline_ms)},
               {"mapping_jobs", jobs_json(run.job_seconds)}};
  if (pace == Pace::same_thread) json["frame_thread_without_jobs_ms"] = to_json(summarise_without_jobs(run.frames));
  if (pace == Pace::live) json["late"] = late_json(run);
  if (mission) json["mission"] = to_json(mission->statistics);
  if (mission && mission->errors) json["errors"] = to_json(*mission->errors);
  json["cpu_s"] = resources.cpu_seconds;
  json["wall_s"] = run.wall_seconds;
  json["peak_memory_mb"] = resources.peak_memory_mb;
  json["warnings"] = warnings_json(run.warnings);
  return json;
}

Json milliseconds_json(const MappedFrame& frame) {
  const StageSeconds& seconds = frame.seconds;
  Json json;
  const auto add = [&json](const char* name, double value) { json[name] = rounded_ms(kMillisecondsPerSecond * value); };
  add("decode", seconds.decode);
  add("rectify", seconds.rectify);
  add("extract", seconds.extract);
  add("stereo", seconds.stereo);
  add("track", seconds.track);
  add("map", seconds.map);
  add("map_submit", seconds.map_submit);
  add("total", seconds.total);
  const std::optional<double> job = frame.report->job_seconds;
  json["job_taken_over"] = job ? Json(rounded_ms(kMillisecondsPerSecond * *job)) : Json();
  return json;
}

Json frame_json(const MappedFrame& frame, const PoseError* error) {
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
  if (report.map_from_body) json.update(pose_json(*report.map_from_body, report.covariance));
  if (report.odometry_from_body) json["odometry"] = pose_json(*report.odometry_from_body, report.odometry_covariance);
  json["health"] = health_json(report.health);
  if (error != nullptr) json["error"] = {{"position_m", error->position()}, {"rotation_deg", error->rotation()}};
  json["ms"] = milliseconds_json(frame);
  return json;
}

}  // namespace

std::string to_json(const MapRun& run, const MapProtocol& protocol, const ResourceUsage& resources,
                    const std::optional<MissionOutcome>& mission) {
  std::string text = dump_json(run_json(run, protocol, resources, mission), 2);
  text.erase(text.rfind("\n}"));
  text += ",\n  \"frames\": [";
  const char* separator = "\n    ";
  for (const MappedFrame& frame : run.frames) {
    const bool has_truth = mission && mission->errors;
    const PoseError* const error = has_truth ? find_error(mission->errors->causal, frame.time) : nullptr;
    text += separator + dump_json(frame_json(frame, error));
    separator = ",\n    ";
  }
  return text + "\n  ]\n}\n";
}

}  // namespace byre
