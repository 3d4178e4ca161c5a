#include "byre/cli/map_report.h"

#include "byre/cli/formatted.h"
#include "byre/cli/map_statistics.h"
#include "byre/evaluation/trajectory_error.h"

#include <sys/resource.h>

namespace byre::cli {
namespace {

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::string row(const char* name, const std::string& content) {
  return formatted("%-12s ", name) + content + "\n";
}

std::string describe_recording(const MapRun& run, const MapProtocol& protocol) {
  std::string text = protocol.recording + formatted(", %d frames", protocol.frames_in_range);
  const auto frames = static_cast<int>(run.frames.size());
  if (frames < protocol.frames_in_range) text += formatted(", stopped after %d", frames);
  return text;
}

std::string describe_poses(const FrameCounts& counts) {
  std::string text = formatted("%d of %d frames (%.1f %%)", counts.with_pose, counts.frames, 100.0 * counts.coverage());
  if (counts.lost_episodes > 0) text += formatted(", lost %d times for %d frames", counts.lost_episodes, counts.lost);
  if (counts.resets > 0) text += formatted(", begun anew %d times", counts.resets);
  return text;
}

std::string describe(const TimeSummary& times) {
  return formatted("mean %.1f ms, p99 %.1f ms", times.mean_ms, times.p99_ms);
}

std::string describe_frame_time(const MapRun& run, Pace pace) {
  const std::string total = describe(summarise_stage(run.frames, &StageSeconds::total));
  if (pace != Pace::same_thread) return total;
  return total + "; without mapping jobs " + describe(summarise_without_jobs(run.frames));
}

std::string describe_mapping(const MapRun& run) {
  const TimeSummary jobs = summarise_times(run.job_seconds);
  return formatted("%d jobs, mean %.1f ms, max %.1f ms", jobs.count, jobs.mean_ms, jobs.max_ms);
}

std::string describe_late(const MapRun& run) {
  const TimeSummary late = summarise_times(run.lateness);
  if (late.count == 0) return "no frame";
  return formatted("%d frames, by up to %.1f ms", late.count, late.max_ms);
}

std::string describe_processor(const MapRun& run, const ResourceUse& resources) {
  const double rate = run.wall_seconds > 0.0 ? static_cast<double>(run.frames.size()) / run.wall_seconds : 0.0;
  return formatted("%.1f s, in %.1f s of wall time: %.1f frames/s", resources.cpu_seconds, run.wall_seconds, rate);
}

std::string listing(const std::vector<std::string>& files) {
  std::string text;
  for (const std::string& file : files) text += (text.empty() ? "" : ", ") + file;
  return text;
}

}  // namespace

ResourceUse resources_used_so_far() {
  constexpr double kMegabytesPerKibibyte = 1024.0 / 1e6;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
          kMegabytesPerKibibyte * static_cast<double>(usage.ru_maxrss)};
}

std::string to_text(const MapRun& run, const MapProtocol& protocol, const ResourceUse& resources,
                    const std::vector<std::string>& files) {
  const FrameCounts counts = count_frames(run.frames);
  std::string text = row("recording", describe_recording(run, protocol));
  text += row("pace", std::string(name_of(protocol.options.pace)));
  text += row("poses", describe_poses(counts));
  text += row("map", formatted("%d keyframes, of %d made; %d points", run.map.keyframe_count(), counts.keyframes,
                               run.map.point_count()));
  text += row("path", formatted("%.2f m", path_length(run.final)));
  text += row("frame time", describe_frame_time(run, protocol.options.pace));
  text += row("mapping", describe_mapping(run));
  if (protocol.options.pace == Pace::live) text += row("late", describe_late(run));
  text += row("CPU time", describe_processor(run, resources));
  text += row("memory", formatted("%.0f MB at most", resources.peak_memory_mb));
  if (!run.warnings.empty()) {
    text += row("warnings", formatted("%zu; the first: ", run.warnings.size()) + run.warnings.front());
  }
  text += row("written", listing(files));
  return text;
}

}  // namespace byre::cli
