#include "byre/playback/report/run_report.h"

#include "byre/map/mapped_tag.h"
#include "byre/playback/report/calibration_report.h"
#include "byre/playback/report/map_report.h"
#include "byre/playback/report/recording_report.h"
#include "byre/playback/report/report.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kListedWarnings = 20;
constexpr const char* kCovariance =
    "6x6, row-major, of a small motion (translation in metres, rotation vector in radians) in the body frame, relative "
    "to the map's origin";

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

Json map_protocol_json(const RunProtocol& protocol) {
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

Json counts_json(const RunResult& run, const FrameCounts& counts) {
  Json refused_starts = Json::object();
  for (const auto& [failure, frames] : counts.refused_starts) refused_starts[std::string(to_string(failure))] = frames;
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
          {"refused_starts", refused_starts},
          {"lost_episodes", counts.lost_episodes},
          {"frames_lost", counts.lost},
          {"frames_located_afterwards", run.located_afterwards},
          {"frames_not_joined", run.not_joined.size()},
          {"resets", counts.resets},
          {"relocalisations", counts.relocalisations},
          {"loops_on_the_way", counts.loops},
          {"corrections_on_the_way", counts.corrections}};
}

// Keyframes per recording, and frames until the new recording was localised in the map; null unless a map is extended.
Json extension_json(const RunResult& run, const RunProtocol& protocol, const FrameCounts& counts) {
  if (protocol.extended.empty()) return nullptr;
  const std::vector<int> keyframes = keyframes_of_recordings(run.stored.map, protocol.recordings.size());
  Json recordings = Json::array();
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    recordings.push_back({{"name", protocol.recordings[i]}, {"keyframes", keyframes[i]}});
  }
  return {{"frames_until_found", or_null(counts.frames_to_first)}, {"recordings", recordings}};
}

Json summary_json(const Distribution& times) {
  if (times.count == 0) return nullptr;
  return {{"mean", rounded_ms(times.mean)},
          {"p50", rounded_ms(times.p50)},
          {"p95", rounded_ms(times.p95)},
          {"p99", rounded_ms(times.p99)},
          {"max", rounded_ms(times.max)}};
}

Json stages_json(const std::vector<PlayedFrame>& frames) {
  const auto stage = [&frames](double StageSeconds::*member) { return summary_json(summarise_stage(frames, member)); };
  return {{"decode", stage(&StageSeconds::decode)},   {"rectify", stage(&StageSeconds::rectify)},
          {"extract", stage(&StageSeconds::extract)}, {"stereo", stage(&StageSeconds::stereo)},
          {"track", stage(&StageSeconds::track)},     {"map", stage(&StageSeconds::map)}};
}

Json jobs_json(const std::vector<double>& job_seconds) {
  const Distribution jobs = summarise_times(job_seconds);
  return {{"count", jobs.count}, {"mean_ms", rounded_ms(jobs.mean)}, {"max_ms", rounded_ms(jobs.max)}};
}

Json late_json(const RunResult& run) {
  const Distribution late = summarise_times(run.lateness);
  return {{"frames", late.count}, {"max_ms", rounded_ms(late.max)}};
}

Json deadline_json(const FrameCounts& counts, double deadline_ms) {
  if (deadline_ms <= 0.0) return nullptr;
  return {{"deadline_ms", deadline_ms},
          {"frames_late", counts.late},
          {"frames_without_online_points", counts.without_online_points},
          {"frames_with_left_image_alone", counts.with_left_alone}};
}

Json warnings_json(const std::vector<std::string>& warnings) {
  const auto listed = static_cast<std::ptrdiff_t>(std::min(warnings.size(), kListedWarnings));
  return {{"count", warnings.size()}, {"first", std::vector(warnings.begin(), warnings.begin() + listed)}};
}

// Most frequent reason first; empty without refusals.
std::string describe_refusals(const FrameCounts& counts) {
  std::vector<std::pair<int, TwoViewFailure>> ranked;
  for (const auto& [failure, frames] : counts.refused_starts) ranked.emplace_back(-frames, failure);
  std::ranges::sort(ranked);
  std::string text;
  for (const auto& [frames, failure] : ranked) {
    text += (text.empty() ? "" : ", ") + std::string(to_string(failure)) + fmt::format(" {}", -frames);
  }
  return text.empty() ? text : text + " frames";
}

// Initialisation and scale of a monocular map; none for other runs.
void add_scale(const RunResult& run, const RunProtocol& protocol, const FrameCounts& counts, Report& report) {
  if (protocol.is_metric) return;
  Json more = {{"refusals", describe_refusals(counts)},
               {"is_metric", run.is_metric},
               {"scale_source", run.motion.is_scaled_by_tags ? "AprilTags" : "wheel odometry"},
               {"scale_sigma", or_null(run.motion.scale_sigma)}};
  const auto first = std::ranges::find_if(run.frames, [](const PlayedFrame& frame) {
    return frame.report && frame.report->has(SessionEvent::initialised);
  });
  if (first != run.frames.end()) {
    more["seconds"] = to_seconds(first->time - run.frames.front().time);
    more["frame"] = first - run.frames.begin();
  }
  report.row("initialised",
             "[{seconds:.2f} s after the first frame, at frame {frame}|never]"
             "[{?refusals}; earlier attempts failed: {refusals}]",
             more);
  report.row("scale",
             "[metric by {scale_source} (sigma {scale_sigma*100:.2f} %)|{?is_metric}metric by the map"
             "|arbitrary; set it with \"byre scale\"]",
             more);
}

void add_map(Report& report) {
  report.row("map",
             "{keyframes_left} keyframes left of [{?extension}the extended map and ]{keyframes_made} made; "
             "{points} points",
             report.figures["counts"]);
}

void add_loops(Report& report) {
  report.detail("loops",
                "{loops_on_the_way} closed while tracking, {corrections_on_the_way} corrections of the whole map"
                "[{?relocalisations}; relocalised {relocalisations} times]",
                report.figures["counts"]);
}

void add_finishing(const RunResult& run, const RunProtocol& protocol, Report& report) {
  if (run.finishing) {
    if (run.calibration) {
      report.row("calibration",
                 "[error about {calibration_row_error_px:.2f} px (row differences of the pair); ]{description}",
                 {{"description", describe_calibration(*run.calibration)}});
    }
    report.append(finish_report(*run.finishing));
  } else if (!protocol.options.close_loops) {
    report.row("finishing", "skipped (--no-loops)");
  } else {
    report.row("finishing", run.final.empty() ? "skipped, no map" : "skipped; run \"byre refine\"");
  }
}

void add_map_rows(const RunResult& run, const RunProtocol& protocol, const FrameCounts& counts, Report& report) {
  report.row("poses",
             "{frames_with_pose} of {frames} frames ({coverage*100:.1f} %)"
             "[{?lost_episodes}, lost {lost_episodes} times for {frames_lost} frames]"
             "[{?resets}, reinitialised {resets} times][{?frames_located_afterwards}; {frames_located_afterwards} more "
             "located in the finished map][{?frames_unreadable}; {frames_unreadable} could not be read]",
             report.figures["counts"]);
  if (!run.not_joined.empty()) {
    const auto seconds = [&](Timestamp time) { return to_seconds(time - run.frames.front().time); };
    report.row("not joined",
               "{frames_not_joined} frames, {first:.1f} to {last:.1f} s: parts that show no place of the map are left "
               "out; map them alone with --start and --end",
               {{"frames_not_joined", run.not_joined.size()},
                {"first", seconds(run.not_joined.front())},
                {"last", seconds(run.not_joined.back())}});
  }
  add_scale(run, protocol, counts, report);
  add_map(report);
  report.row("tags", "{?tags}{tags} AprilTags in the map", {{"tags", stored_tags(run.stored.notes).size()}});
  if (!protocol.extended.empty()) {
    report.row("extended",
               "{protocol.extended}[, localised in it after {extension.frames_until_found} frames"
               "|, never localised in it]");
    for (const Json& recording : report.figures["extension"]["recordings"]) {
      report.row("of", "{name}, {keyframes} keyframes", recording);
    }
  }
  if (protocol.options.close_loops) add_loops(report);
  add_finishing(run, protocol, report);
}

// Frames on each map of a site, in order of first use; empty without a site.
Json frames_by_map(const RunResult& run) {
  Json maps = Json::array();
  for (const PlayedFrame& frame : run.frames) {
    if (!frame.report || frame.report->map.empty()) continue;
    const FrameReport& report = *frame.report;
    auto map = std::ranges::find_if(maps, [&](const Json& each) { return each["name"] == report.map; });
    if (map == maps.end()) {
      maps.push_back({{"name", report.map}, {"frames", 0}, {"frames_trusted", 0}});
      map = std::prev(maps.end());
    }
    (*map)["frames"] = (*map)["frames"].get<int>() + 1;
    (*map)["frames_trusted"] =
        (*map)["frames_trusted"].get<int>() + (report.health.verdict == Verdict::trusted ? 1 : 0);
  }
  return maps;
}

// Rows of a "byre run" report, with or without an offline map.
void add_mission_rows(const MissionOutcome& mission, const RunResult& run, const RunProtocol& protocol,
                      const FrameCounts& counts, Report& report) {
  const bool has_map = run.offline != nullptr;
  const bool maps = protocol.options.session.map_online;
  if (has_map) {
    const MapGraph& map = run.offline->map();
    report.row("offline map",
               "[{?site}{map}, at the end|{map}], {keyframes} keyframes, {points} points[{!maps}; no online mapping "
               "(--localise-only)]"
               "[{?plan}; poses on the plan {plan}]",
               {{"map", protocol.offline},
                {"site", !run.frames.empty() && run.frames.front().report && !run.frames.front().report->map.empty()},
                {"keyframes", map.keyframe_count()},
                {"points", map.point_count()},
                {"maps", maps},
                {"plan", protocol.plan ? Json(protocol.plan->plan) : Json()}});
    if (Json by_map = frames_by_map(run); !by_map.empty()) {
      for (const Json& one : by_map) report.row("on map", "{name}: {frames} frames, {frames_trusted} trusted", one);
      report.figures["maps"] = std::move(by_map);
    }
  }
  report.row("poses",
             "{counts.frames_with_pose} of {counts.frames} frames ({counts.coverage*100:.1f} %)"
             "[, the first after {mission.seconds_to_first_pose:.2f} s]");
  add_scale(run, protocol, counts, report);
  report.append(mission_report(mission.statistics));
  if (maps && !has_map) add_map(report);
  if (maps && has_map) {
    // Without the offline points that online keyframes observe.
    Json last;
    if (!run.frames.empty()) last = {{"keyframes", run.frames.back().keyframes}, {"points", run.frames.back().points}};
    report.detail("online map", "[{keyframes} keyframes left of {counts.keyframes_made} made; {points} points|none]",
                  last);
  }
  if (maps) add_loops(report);
  if (!has_map) add_finishing(run, protocol, report);
  if (has_map && maps) {
    report.detail("finishing",
                  "[{seconds:.1f} s: adjustment of the online map together with the offline map in view|skipped]",
                  {{"seconds", or_null(run.mission_finishing_seconds)}});
  }
  if (mission.errors) report.append(mission_error_report(*mission.errors));
}

void add_cost(const RunResult& run, const RunProtocol& protocol, Report& report) {
  report.detail("frame time",
                "[mean {frame_thread_ms.mean:.1f} ms, p99 {frame_thread_ms.p99:.1f} ms|no frame]"
                "[; without mapping jobs mean {frame_thread_without_jobs_ms.mean:.1f} ms, "
                "p99 {frame_thread_without_jobs_ms.p99:.1f} ms]");
  report.detail("deadline",
                "{deadline.deadline_ms:g} ms: {deadline.frames_late} frames late; "
                "{deadline.frames_without_online_points} with limited online points, "
                "{deadline.frames_with_left_image_alone} without the right image");
  report.detail("mapping", "{count} jobs, mean {mean_ms:.1f} ms, max {max_ms:.1f} ms", report.figures["mapping_jobs"]);
  if (protocol.options.pace == Pace::live) {
    report.row("late", "[{?late.frames}{late.frames} frames, at most {late.max_ms:.1f} ms|no frame]");
  }
  const double seconds = run.wall_seconds - (run.finishing ? run.finishing->seconds : 0.0);
  report.detail("CPU time", "{cpu_s:.1f} s, in {wall_s:.1f} s of wall time: {rate:.1f} frames/s",
                {{"rate", seconds > 0.0 ? static_cast<double>(run.frames.size()) / seconds : 0.0}});
  Json memory;
  if (!run.frames.empty()) memory = {{"first", run.frames.front().memory_mb}, {"last", run.frames.back().memory_mb}};
  report.detail("memory",
                "peak {peak_memory_mb:.0f} MB[; {first:.0f} MB after the first frame, {last:.0f} MB after the last]",
                memory);
}

Json run_figures(const RunResult& run, const RunProtocol& protocol, const ResourceUsage& resources,
                 const FrameCounts& counts, const std::optional<MissionOutcome>& mission) {
  const Pace pace = protocol.options.pace;
  Json json = {{"protocol", map_protocol_json(protocol)},
               {"stopped_early", static_cast<int>(run.frames.size()) < protocol.frames_in_range},
               {"counts", counts_json(run, counts)},
               {"extension", extension_json(run, protocol, counts)},
               {"calibration", run.calibration ? calibration_json(*run.calibration) : Json()},
               {"calibration_row_error_px", or_null(run.row_error)},
               {"finishing", run.finishing ? finish_report(*run.finishing).figures : Json()},
               {"frame_thread_ms", summary_json(summarise_stage(run.frames, &StageSeconds::total))},
               {"stages_ms", stages_json(run.frames)},
               {"deadline", deadline_json(counts, protocol.options.frame_deadline_ms)},
               {"mapping_jobs", jobs_json(run.job_seconds)}};
  if (pace == Pace::same_thread) {
    json["frame_thread_without_jobs_ms"] = summary_json(summarise_without_jobs(run.frames));
  }
  if (pace == Pace::live) json["late"] = late_json(run);
  if (mission) json["mission"] = mission_report(mission->statistics).figures;
  if (mission && mission->errors) json["errors"] = mission_error_report(*mission->errors).figures;
  json["cpu_s"] = resources.cpu_seconds;
  json["wall_s"] = run.wall_seconds;
  json["peak_memory_mb"] = resources.peak_memory_mb;
  json["warnings"] = warnings_json(run.warnings);
  return json;
}

}  // namespace

Report run_report(const RunResult& run, const RunProtocol& protocol, const ResourceUsage& resources,
                  const std::optional<MissionOutcome>& mission) {
  const FrameCounts counts = count_frames(run.frames);
  Report report{run_figures(run, protocol, resources, counts, mission)};
  report.row(
      "recording",
      "{protocol.recording}, {protocol.frames_in_range} frames"
      "[{?is_rgbd}, {counts.frames_with_depth_image} with depth images"
      "|{?is_one_camera} of the {protocol.camera} camera][{?stopped_early}, stopped after {counts.frames}]",
      {{"is_rgbd", protocol.camera == CameraChoice::rgbd}, {"is_one_camera", protocol.camera != CameraChoice::stereo}});
  report.detail("pace", "{protocol.pace}");
  if (mission) {
    add_mission_rows(*mission, run, protocol, counts, report);
  } else {
    add_map_rows(run, protocol, counts, report);
  }
  add_motion(run, protocol.is_metric, report);
  report.row(
      "path", "{length:.2f} {unit}, through {poses} final poses",
      {{"length", path_length(run.final)}, {"unit", run.is_metric ? "m" : "units"}, {"poses", run.final.size()}});
  add_cost(run, protocol, report);
  report.row("warnings", "{?warnings.count}{warnings.count}; the first: {warnings.first.0}");
  return report;
}

void require_frames(int unreadable, int frames, const std::vector<std::string>& warnings) {
  if (!misses_too_many_frames(unreadable, frames)) return;
  std::string text = fmt::format("{} of {} frames could not be read", unreadable, frames);
  if (!warnings.empty()) text += ", see the warnings: " + warnings.front();
  throw std::runtime_error(text + " (record or copy these images again, or exclude them with --frames)");
}

void require_poses(const RunResult& run, const RunProtocol& protocol) {
  if (!run.final.empty()) return;
  const FrameCounts counts = count_frames(run.frames);
  if (2 * counts.unreadable > counts.frames) {
    throw std::runtime_error(fmt::format("no frame got a pose: {} of {} could not be read; see the warnings",
                                         counts.unreadable, counts.frames));
  }
  const std::string& before = protocol.extended.empty() ? protocol.offline : protocol.extended;
  if (!before.empty()) {
    throw std::runtime_error("no frame was localised in " + before +
                             ": the recording may be of another place, or differ too much in lighting or viewpoint");
  }
  const std::string refusals = describe_refusals(counts);
  if (!refusals.empty()) {
    throw std::runtime_error("no frame got a pose: monocular initialisation needs sideways motion: " + refusals);
  }
  throw std::runtime_error("no frame got a pose: the images may be too dark or without texture");
}

}  // namespace byre
