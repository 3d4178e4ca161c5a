#include "byre/playback/report/run_report.h"

#include "byre/base/report_row.h"
#include "byre/playback/report/calibration_report.h"
#include "byre/playback/report/finish_report.h"
#include "byre/playback/report/motion_report.h"
#include "byre/slam/system/stored_map.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

std::string describe_poses(const FrameCounts& counts) {
  std::string text =
      fmt::format("{} of {} frames ({:.1f} %)", counts.with_pose, counts.frames, 100.0 * counts.coverage());
  if (counts.lost_episodes > 0) text += fmt::format(", lost {} times for {} frames", counts.lost_episodes, counts.lost);
  if (counts.resets > 0) text += fmt::format(", reinitialised {} times", counts.resets);
  if (counts.unreadable > 0) text += fmt::format("; {} could not be read", counts.unreadable);
  return text;
}

std::string describe_map(const MapRun& run, const MapProtocol& protocol, const FrameCounts& counts) {
  return fmt::format("{} keyframes left of {}{} made; {} points", run.stored.map.keyframe_count(),
                     protocol.extended.empty() ? "" : "the extended map and ", counts.keyframes,
                     run.stored.map.point_count());
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

// Initialisation and scale of a monocular map; empty for other runs.
std::string scale_rows(const MapRun& run, const MapProtocol& protocol, const FrameCounts& counts) {
  if (protocol.is_metric) return "";
  std::string begun = "never";
  const auto first = std::ranges::find_if(run.frames, [](const MappedFrame& frame) {
    return frame.report && frame.report->has(SessionEvent::initialised);
  });
  if (first != run.frames.end()) {
    const double seconds = to_seconds(first->time - run.frames.front().time);
    begun = fmt::format("{:.2f} s after the first frame, at frame {}", seconds,
                        static_cast<int>(first - run.frames.begin()));
  }
  const std::string refusals = describe_refusals(counts);
  if (!refusals.empty()) begun += "; earlier attempts failed: " + refusals;
  const std::string scale = run.is_metric ? fmt::format("metric by wheel odometry (sigma {:.2f} %)",
                                                        100.0 * run.motion.scale_sigma.value_or(0.0))
                                          : "arbitrary; set it with \"byre scale\"";
  return row("initialised", begun) + row("scale", scale);
}

std::string describe_loops(const FrameCounts& counts) {
  std::string text =
      fmt::format("{} closed while tracking, {} corrections of the whole map", counts.loops, counts.corrections);
  if (counts.relocalisations > 0) text += fmt::format("; relocalised {} times", counts.relocalisations);
  return text;
}

// Empty unless a map is extended.
std::string extension_rows(const MapRun& run, const MapProtocol& protocol, const FrameCounts& counts) {
  if (protocol.extended.empty()) return "";
  const std::string found = counts.frames_to_first
                                ? fmt::format(", localised in it after {} frames", *counts.frames_to_first)
                                : std::string(", never localised in it");
  std::string text = row("extended", protocol.extended + found);
  const std::vector<int> keyframes = keyframes_of_recordings(run.stored.map, protocol.recordings.size());
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    text += row("of", protocol.recordings[i] + fmt::format(", {} keyframes", keyframes[i]));
  }
  return text;
}

std::string describe_recording(const MapRun& run, const MapProtocol& protocol) {
  std::string text = protocol.recording + fmt::format(", {} frames", protocol.frames_in_range);
  if (protocol.camera == CameraChoice::rgbd) {
    text += fmt::format(", {} with depth images", count_frames(run.frames).with_depth_image);
  } else if (protocol.camera != CameraChoice::stereo) {
    text += fmt::format(" of the {} camera", to_string(protocol.camera));
  }
  const auto frames = static_cast<int>(run.frames.size());
  if (frames < protocol.frames_in_range) text += fmt::format(", stopped after {}", frames);
  return text;
}

std::string describe(const TimeSummary& times) {
  return fmt::format("mean {:.1f} ms, p99 {:.1f} ms", times.mean_ms, times.p99_ms);
}

std::string describe_frame_time(const MapRun& run, Pace pace) {
  const std::string total = describe(summarise_stage(run.frames, &StageSeconds::total));
  if (pace != Pace::same_thread) return total;
  return total + "; without mapping jobs " + describe(summarise_without_jobs(run.frames));
}

std::string describe_mapping(const MapRun& run) {
  const TimeSummary jobs = summarise_times(run.job_seconds);
  return fmt::format("{} jobs, mean {:.1f} ms, max {:.1f} ms", jobs.count, jobs.mean_ms, jobs.max_ms);
}

std::string describe_late(const MapRun& run) {
  const TimeSummary late = summarise_times(run.lateness);
  if (late.count == 0) return "no frame";
  return fmt::format("{} frames, at most {:.1f} ms", late.count, late.max_ms);
}

std::string describe_deadline(const MapRun& run, double deadline_ms) {
  const FrameCounts counts = count_frames(run.frames);
  return fmt::format("{:g} ms: {} frames late; {} with limited online points, {} without the right image", deadline_ms,
                     counts.late, counts.without_online_points, counts.with_left_alone);
}

std::string describe_processor(const MapRun& run, const ResourceUsage& resources) {
  const double seconds = run.wall_seconds - (run.finishing ? run.finishing->seconds : 0.0);
  const double rate = seconds > 0.0 ? static_cast<double>(run.frames.size()) / seconds : 0.0;
  return fmt::format("{:.1f} s, in {:.1f} s of wall time: {:.1f} frames/s", resources.cpu_seconds, run.wall_seconds,
                     rate);
}

std::string describe_memory(const MapRun& run, const ResourceUsage& resources) {
  std::string text = fmt::format("peak {:.0f} MB", resources.peak_memory_mb);
  if (run.frames.empty()) return text;
  return text + fmt::format("; {:.0f} MB after the first frame, {:.0f} MB after the last", run.frames.front().memory_mb,
                            run.frames.back().memory_mb);
}

std::string comma_separated(const std::vector<std::string>& files) {
  std::string text;
  for (const std::string& file : files) text += (text.empty() ? "" : ", ") + file;
  return text;
}

std::string recording_rows(const MapRun& run, const MapProtocol& protocol) {
  return row("recording", describe_recording(run, protocol)) + row("pace", std::string(name_of(protocol.options.pace)));
}

std::string finishing_rows(const MapRun& run, const MapProtocol& protocol) {
  if (run.finishing) return calibration_row(run.calibration, run.row_error) + to_text(*run.finishing);
  if (!protocol.options.close_loops) return row("finishing", "skipped (--no-loops)");
  if (run.final.empty()) return row("finishing", "skipped, no map");
  return row("finishing", "skipped; run \"byre refine\"");
}

std::string cost_rows(const MapRun& run, const MethodOptions& options, const ResourceUsage& resources) {
  const Pace pace = options.pace;
  std::string text = row("frame time", describe_frame_time(run, pace));
  if (options.frame_deadline_ms > 0.0) text += row("deadline", describe_deadline(run, options.frame_deadline_ms));
  text += row("mapping", describe_mapping(run));
  if (pace == Pace::live) text += row("late", describe_late(run));
  text += row("CPU time", describe_processor(run, resources));
  text += row("memory", describe_memory(run, resources));
  return text;
}

std::string closing_rows(const MapRun& run, const std::vector<std::string>& files) {
  std::string text;
  if (!run.warnings.empty()) {
    text += row("warnings", fmt::format("{}; the first: ", run.warnings.size()) + run.warnings.front());
  }
  if (!files.empty()) text += row("written", comma_separated(files));
  return text;
}

std::string describe_offline(const MapRun& run, const MapProtocol& protocol) {
  const Map& map = run.offline->map();
  return protocol.offline + fmt::format(", {} keyframes, {} points", map.keyframe_count(), map.point_count()) +
         (protocol.options.session.map_online ? "" : "; no online mapping (--localise-only)") +
         (protocol.plan ? "; poses on the plan " + protocol.plan->plan : std::string());
}

std::string map_rows(const MapRun& run, const MapProtocol& protocol) {
  const FrameCounts counts = count_frames(run.frames);
  std::string text = row("poses", describe_poses(counts));
  text += scale_rows(run, protocol, counts);
  text += row("map", describe_map(run, protocol, counts));
  text += extension_rows(run, protocol, counts);
  if (protocol.options.close_loops) text += row("loops", describe_loops(counts));
  text += finishing_rows(run, protocol);
  return text;
}

std::string describe_coverage(const MapRun& run, const MissionStatistics& statistics) {
  const FrameCounts counts = count_frames(run.frames);
  std::string text =
      fmt::format("{} of {} frames ({:.1f} %)", counts.with_pose, counts.frames, 100.0 * counts.coverage());
  if (!statistics.seconds_to_first_pose) return text;
  return text + fmt::format(", the first after {:.2f} s", *statistics.seconds_to_first_pose);
}

// Without the offline points that online keyframes observe.
std::string describe_online(const MapRun& run, const FrameCounts& counts) {
  if (run.frames.empty()) return "none";
  return fmt::format("{} keyframes left of {} made; {} points", run.frames.back().keyframes, counts.keyframes,
                     run.frames.back().points);
}

std::string describe_mission_finishing(const MapRun& run) {
  if (!run.mission_finishing_seconds) return "skipped";
  return fmt::format("{:.1f} s: adjustment of the whole online map, with the offline map fixed",
                     *run.mission_finishing_seconds);
}

// Rows of a "byre run" report, with or without an offline map.
std::string mission_rows(const MissionOutcome& mission, const MapRun& run, const MapProtocol& protocol) {
  const FrameCounts counts = count_frames(run.frames);
  const bool has_map = run.offline != nullptr;
  std::string text;
  if (has_map) text += row("offline map", describe_offline(run, protocol));
  text += row("poses", describe_coverage(run, mission.statistics));
  text += scale_rows(run, protocol, counts);
  text += to_text(mission.statistics);
  if (protocol.options.session.map_online) {
    text += has_map ? row("online map", describe_online(run, counts)) : row("map", describe_map(run, protocol, counts));
    text += row("loops", describe_loops(counts));
  }
  if (!has_map) text += finishing_rows(run, protocol);
  if (has_map && protocol.options.session.map_online) text += row("finishing", describe_mission_finishing(run));
  if (mission.errors) text += to_text(*mission.errors);
  return text;
}

}  // namespace

std::string to_text(const MapRun& run, const MapProtocol& protocol, const ResourceUsage& resources,
                    const std::vector<std::string>& files, const std::optional<MissionOutcome>& mission) {
  std::string text = recording_rows(run, protocol);
  text += mission ? mission_rows(*mission, run, protocol) : map_rows(run, protocol);
  text += motion_rows(run, protocol.is_metric);
  text += row("path", fmt::format("{:.2f} {}, through {} final poses", path_length(run.final),
                                  run.is_metric ? "m" : "units", run.final.size()));
  text += cost_rows(run, protocol.options, resources);
  text += closing_rows(run, files);
  return text;
}

void require_frames(int unreadable, int frames, const std::vector<std::string>& warnings) {
  if (!misses_too_many_frames(unreadable, frames)) return;
  std::string text = fmt::format("{} of {} frames could not be read", unreadable, frames);
  if (!warnings.empty()) text += ", see the warnings: " + warnings.front();
  throw std::runtime_error(text + " (record or copy these images again, or exclude them with --frames)");
}

void require_poses(const MapRun& run, const MapProtocol& protocol) {
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
