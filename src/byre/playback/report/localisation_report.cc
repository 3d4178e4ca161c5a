#include "byre/playback/report/localisation_report.h"

#include "byre/base/report_row.h"
#include "byre/map/keyframe_path.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <map>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kCloseMetres = 0.1;
constexpr double kCloseDegrees = 2.0;
constexpr double kFarFoundMetres = 0.5;

Trajectory found_trajectory(const LocaliseRun& run) {
  Trajectory trajectory;
  for (const LocalisedFrame& frame : run.frames) {
    if (frame.world_from_body) trajectory.push_back({frame.time, *frame.world_from_body});
  }
  return trajectory;
}

std::map<LocalisationFailure, int> count_failures(const LocaliseRun& run) {
  std::map<LocalisationFailure, int> counts;
  for (const LocalisedFrame& frame : run.frames) {
    if (!frame.world_from_body) ++counts[frame.localisation.failure];
  }
  return counts;
}

int count_found(const LocaliseRun& run) {
  return static_cast<int>(
      std::ranges::count_if(run.frames, [](const LocalisedFrame& frame) { return frame.world_from_body.has_value(); }));
}

ErrorStatistics inlier_statistics(const LocaliseRun& run) {
  std::vector<double> inliers;
  for (const LocalisedFrame& frame : run.frames) {
    if (frame.world_from_body) inliers.push_back(frame.localisation.inliers);
  }
  return summarise(inliers);
}

template <typename Duration>
ErrorStatistics milliseconds(const LocaliseRun& run, Duration duration) {
  std::vector<double> times;
  for (const LocalisedFrame& frame : run.frames) times.push_back(1e3 * duration(frame));
  return summarise(times);
}

ErrorStatistics extract_times(const LocaliseRun& run) {
  return milliseconds(run, [](const LocalisedFrame& frame) { return frame.extract_seconds; });
}
ErrorStatistics localise_times(const LocaliseRun& run) {
  return milliseconds(run, [](const LocalisedFrame& frame) { return frame.localise_seconds; });
}

struct ErrorSummary {
  ErrorStatistics position;  // metres
  ErrorStatistics rotation;  // degrees
  int close = 0;             // frames within kCloseMetres and kCloseDegrees
  int far = 0;               // frames off by more than kFarFoundMetres
};

ErrorSummary summarise_errors(const LocalisationErrors& errors) {
  ErrorSummary summary;
  for (const PoseError& error : errors.errors) {
    summary.close += error.position() <= kCloseMetres && error.rotation() <= kCloseDegrees;
    summary.far += error.position() > kFarFoundMetres;
  }
  summary.position = position_statistics(errors.errors);
  summary.rotation = rotation_statistics(errors.errors);
  return summary;
}

double percent(int part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * part / static_cast<double>(whole);
}

std::string error_rows(const LocalisationErrors& errors, std::size_t frames) {
  const ErrorSummary summary = summarise_errors(errors);
  std::string text =
      row("truth", errors.alignment_keyframes == 0
                       ? std::string("in the map's frame, without alignment")
                       : fmt::format("aligned to the map by its {} keyframes", errors.alignment_keyframes));
  text += row("position", fmt::format("median {:.4f} m, 95 % within {:.4f} m, max {:.4f} m", summary.position.median,
                                      summary.position.p95, summary.position.max));
  text += row("rotation", fmt::format("median {:.3f} deg, 95 % within {:.3f} deg, max {:.3f} deg",
                                      summary.rotation.median, summary.rotation.p95, summary.rotation.max));
  text += row("close", fmt::format("{} of {} frames ({:.1f} %) within {:g} m and {:g} deg", summary.close, frames,
                                   percent(summary.close, frames), kCloseMetres, kCloseDegrees));
  text += row("far", fmt::format("{} accepted frames with an error above {:g} m", summary.far, kFarFoundMetres));
  return text;
}

void add_pose(const Pose& frame_from_body, const char* position_name, const char* rotation_name, Json& json) {
  const Eigen::Vector3d& position = frame_from_body.translation;
  const Eigen::Vector4d rotation = frame_from_body.rotation.coeffs();
  json[position_name] = {position.x(), position.y(), position.z()};
  json[rotation_name] = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
}

Json frame_json(const LocalisedFrame& frame, const std::optional<PlanRegistration>& plan) {
  const Localisation& found = frame.localisation;
  Json json = {{"name", frame.name},
               {"time_s", to_seconds(frame.time)},
               {"found", frame.world_from_body.has_value()},
               {"reason", frame.world_from_body ? Json() : Json(to_string(found.failure))},
               {"places", found.places},
               {"matches", found.matches},
               {"inliers", found.inliers},
               {"extract_ms", 1e3 * frame.extract_seconds},
               {"localise_ms", 1e3 * frame.localise_seconds}};
  if (!frame.world_from_body) return json;
  add_pose(*frame.world_from_body, "position_in_map_m", "rotation_map_from_body_xyzw", json);
  if (plan) {
    add_pose(plan_from_body(*plan, *frame.world_from_body), "position_on_plan_m", "rotation_plan_from_body_xyzw", json);
  }
  return json;
}

Json errors_json(const LocalisationErrors& errors) {
  const ErrorSummary summary = summarise_errors(errors);
  const auto statistics = [](const ErrorStatistics& of) {
    return Json{{"median", of.median}, {"p95", of.p95}, {"rmse", of.rmse}, {"max", of.max}, {"count", of.count}};
  };
  return {{"alignment_keyframes", errors.alignment_keyframes},
          {"position_m", statistics(summary.position)},
          {"rotation_deg", statistics(summary.rotation)},
          {"frames_within_0.1m_2deg", summary.close},
          {"frames_off_by_more_than_0.5m", summary.far}};
}

}  // namespace

LocalisationErrors errors_in_map(const LocaliseRun& run, const StoredMap& stored, const Trajectory& map_truth,
                                 const Trajectory& truth) {
  const Scale scale = stored.scale == MapScale::metric ? Scale::fixed : Scale::free;
  const MapAlignment alignment = align_to_truth(keyframe_path(stored.map), scale, map_truth);
  return {errors_in_map(found_trajectory(run), truth, alignment), alignment.poses};
}

std::string to_text(const LocaliseRun& run, const LocaliseProtocol& protocol,
                    const std::optional<LocalisationErrors>& errors) {
  const int found = count_found(run);
  std::string text = row("map", protocol.map);
  if (protocol.plan) text += row("plan", protocol.plan->plan);
  text += row("frames", fmt::format("{}, {} frames", protocol.input, protocol.frames));
  text += row("found", fmt::format("{} of {} frames ({:.1f} %), without prediction", found, run.frames.size(),
                                   percent(found, run.frames.size())));
  for (const auto& [failure, count] : count_failures(run)) {
    text += row("not found", fmt::format("{}: ", count) + std::string(to_string(failure)));
  }
  const ErrorStatistics inliers = inlier_statistics(run);
  if (found > 0) text += row("inliers", fmt::format("median {:.0f}", inliers.median));
  text += row("time", fmt::format("median {:.1f} ms to localise, 95 % within {:.1f} ms, after {:.1f} ms to extract",
                                  localise_times(run).median, localise_times(run).p95, extract_times(run).median));
  if (errors) text += error_rows(*errors, run.frames.size());
  if (!run.warnings.empty()) {
    text += row("warnings", fmt::format("{}; the first: ", run.warnings.size()) + run.warnings.front());
  }
  return text;
}

std::string to_json(const LocaliseRun& run, const LocaliseProtocol& protocol,
                    const std::optional<LocalisationErrors>& errors) {
  Json failures = Json::object();
  for (const auto& [failure, count] : count_failures(run)) failures[std::string(to_string(failure))] = count;
  Json json = {{"program", "byre localise"},
               {"version", BYRE_VERSION},
               {"map", protocol.map},
               {"input", protocol.input},
               {"frames", run.frames.size()},
               {"frames_found", count_found(run)},
               {"reasons", failures},
               {"inliers_median", inlier_statistics(run).median},
               {"localise_ms_median", localise_times(run).median},
               {"extract_ms_median", extract_times(run).median}};
  if (errors) json["errors"] = errors_json(*errors);
  json["warnings"] = run.warnings;
  json["per_frame"] = Json::array();
  for (const LocalisedFrame& frame : run.frames) json["per_frame"].push_back(frame_json(frame, protocol.plan));
  return dump_json(json, 1) + "\n";
}

}  // namespace byre
