#include "byre/playback/report/localisation_report.h"

#include "byre/map/keyframe_path.h"

#include <algorithm>
#include <map>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

Trajectory found_trajectory(const LocaliseRun& run) {
  Trajectory trajectory;
  for (const LocalisedFrame& frame : run.frames) {
    if (frame.world_from_body) trajectory.push_back({frame.time, *frame.world_from_body});
  }
  return trajectory;
}

Json failures_json(const LocaliseRun& run) {
  std::map<LocalisationFailure, int> counts;
  for (const LocalisedFrame& frame : run.frames) {
    if (!frame.world_from_body) ++counts[frame.localisation.failure];
  }
  Json json = Json::object();
  for (const auto& [failure, count] : counts) json[std::string(to_string(failure))] = count;
  return json;
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

ErrorStatistics milliseconds(const LocaliseRun& run, double LocalisedFrame::*seconds) {
  std::vector<double> times;
  for (const LocalisedFrame& frame : run.frames) times.push_back(1e3 * frame.*seconds);
  return summarise(times);
}

double percent(int part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * part / static_cast<double>(whole);
}

Json localised_frame_json(const LocalisedFrame& frame, const std::optional<PlanRegistration>& plan) {
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
  if (!frame.map.empty()) json["map"] = frame.map;
  json["position_in_map_m"] = list_json(frame.world_from_body->translation);
  json["rotation_map_from_body_xyzw"] = list_json(frame.world_from_body->rotation.coeffs());
  if (!plan) return json;
  const Pose on_plan = plan_from_body(*plan, *frame.world_from_body);
  json["position_on_plan_m"] = list_json(on_plan.translation);
  json["rotation_plan_from_body_xyzw"] = list_json(on_plan.rotation.coeffs());
  return json;
}

Json localisation_errors_json(const LocalisationErrors& errors) {
  const auto statistics = [](const ErrorStatistics& of) {
    return Json{{"median", of.median}, {"p95", of.p95}, {"rmse", of.rmse}, {"max", of.max}, {"count", of.count}};
  };
  // The keys state the thresholds.
  const auto is_close = [](const PoseError& error) { return error.position() <= 0.1 && error.rotation() <= 2.0; };
  const auto is_far = [](const PoseError& error) { return error.position() > 0.5; };
  return {{"alignment_keyframes", errors.alignment_keyframes},
          {"position_m", statistics(position_statistics(errors.errors))},
          {"rotation_deg", statistics(rotation_statistics(errors.errors))},
          {"frames_within_0.1m_2deg", std::ranges::count_if(errors.errors, is_close)},
          {"frames_off_by_more_than_0.5m", std::ranges::count_if(errors.errors, is_far)}};
}

void add_errors_in_map(const LocalisationErrors& errors, const LocaliseRun& run, Report& report) {
  Json figures = localisation_errors_json(errors);
  figures["close_percent"] = percent(figures["frames_within_0.1m_2deg"], run.frames.size());
  report.row("truth",
             "[{?alignment_keyframes}aligned to the map by its {alignment_keyframes} keyframes"
             "|in the map's frame, without alignment]",
             figures);
  report.row("position",
             "median {position_m.median:.4f} m, 95 % within {position_m.p95:.4f} m, max {position_m.max:.4f} m",
             figures);
  report.row("rotation",
             "median {rotation_deg.median:.3f} deg, 95 % within {rotation_deg.p95:.3f} deg, "
             "max {rotation_deg.max:.3f} deg",
             figures);
  report.row("close", "{frames_within_0.1m_2deg} of {frames} frames ({close_percent:.1f} %) within 0.1 m and 2 deg",
             figures);
  report.row("far", "{frames_off_by_more_than_0.5m} accepted frames with an error above 0.5 m", figures);
}

}  // namespace

LocalisationErrors errors_in_map(const LocaliseRun& run, const StoredMap& stored, const Trajectory& map_truth,
                                 const Trajectory& truth) {
  const Scale scale = stored.scale == MapScale::metric ? Scale::fixed : Scale::free;
  const MapAlignment alignment = align_to_truth(keyframe_path(stored.map), scale, map_truth);
  return {errors_in_map(found_trajectory(run), truth, alignment), alignment.poses};
}

Report localisation_report(const LocaliseRun& run, const LocaliseProtocol& protocol,
                           const std::optional<LocalisationErrors>& errors) {
  const int found = count_found(run);
  const ErrorStatistics localise_ms = milliseconds(run, &LocalisedFrame::localise_seconds);
  Report report{{{"program", "byre localise"},
                 {"version", BYRE_VERSION},
                 {"map", protocol.map},
                 {"input", protocol.input},
                 {"frames", run.frames.size()},
                 {"frames_found", found},
                 {"reasons", failures_json(run)},
                 {"inliers_median", inlier_statistics(run).median},
                 {"localise_ms_median", localise_ms.median},
                 {"extract_ms_median", milliseconds(run, &LocalisedFrame::extract_seconds).median}}};
  if (errors) report.figures["errors"] = localisation_errors_json(*errors);
  report.figures["warnings"] = run.warnings;
  report.row("map", "{map}");
  if (protocol.plan) report.row("plan", "{plan}", {{"plan", protocol.plan->plan}});
  report.row("frames", "{input}, {in_range} frames", {{"in_range", protocol.frames}});
  report.row("found", "{frames_found} of {frames} frames ({found_percent:.1f} %), without prediction",
             {{"found_percent", percent(found, run.frames.size())}});
  for (const auto& [reason, frames] : report.figures["reasons"].items()) {
    report.row("not found", "{count}: {reason}", {{"count", frames}, {"reason", reason}});
  }
  report.row("inliers", "{?frames_found}median {inliers_median:.0f}");
  report.row("time",
             "median {localise_ms_median:.1f} ms to localise, 95 % within {localise_ms_p95:.1f} ms, "
             "after {extract_ms_median:.1f} ms to extract",
             {{"localise_ms_p95", localise_ms.p95}});
  if (errors) add_errors_in_map(*errors, run, report);
  report.row("warnings", "{#warnings}; the first: {warnings.0}");
  report.figures["per_frame"] = Json::array();
  for (const LocalisedFrame& frame : run.frames) {
    report.figures["per_frame"].push_back(localised_frame_json(frame, protocol.plan));
  }
  return report;
}

}  // namespace byre
