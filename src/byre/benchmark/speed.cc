#include "byre/benchmark/speed.h"

#include "byre/base/stopwatch.h"
#include "byre/benchmark/run_cost.h"
#include "byre/playback/scaled_recording.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/resources.h"

#include <array>

namespace byre {
namespace {

constexpr auto kStages = std::to_array<FrameStage>({
    {"decode, ahead", "decode", &StageSeconds::decode},
    {"rectify", "rectify", &StageSeconds::rectify},
    {"extract", "extract", &StageSeconds::extract},
    {"stereo", "stereo", &StageSeconds::stereo},
    {"track", "track", &StageSeconds::track},
    {"map", "map", &StageSeconds::map},
    {"frame", "frame", &StageSeconds::total},
});

SpeedMeasures measures_of(const RunResult& run) {
  SpeedMeasures measures;
  const FrameCounts counts = count_frames(run.frames);
  measures.frames = counts.frames - counts.unreadable;
  measures.with_pose = counts.with_pose;
  measures.keyframes = counts.keyframes;
  measures.late = counts.late;
  measures.without_online_points = counts.without_online_points;
  measures.with_left_alone = counts.with_left_alone;
  for (const FrameStage& stage : kStages) measures.stages.push_back(summarise_stage(run.frames, stage.seconds));
  measures.jobs = summarise_times(run.job_seconds);
  return measures;
}

}  // namespace

std::span<const FrameStage> frame_stages() {
  return kStages;
}

SpeedMeasures measure_speed(const SpeedCase& what, const PlayHooks& hooks) {
  const bool is_reset = reset_peak_memory();
  const double cpu_before = resource_usage().cpu_seconds;
  const InstructionCounter instructions;
  const Stopwatch watch;

  const ScaledRecording opened = open_scaled(what.recording, what.range, what.open, what.map.has_value());
  SlamOptions options = slam_options(what.method);
  options.vocabulary = what.vocabulary;
  options.baseline = what.open.baseline;
  const Calibration& calibration = opened.recording->calibration();
  Slam slam = what.map ? Slam::on_map(calibration, *what.map, options) : Slam::mapping(calibration, options);
  std::optional<double> first_pose_seconds;
  PlayHooks watched = hooks;
  watched.after_frame = [&](int done, const PlayedFrame& frame) {
    const bool has_pose = frame.report && frame.report->map_from_body;
    if (has_pose && !first_pose_seconds) first_pose_seconds = watch.seconds();
    hooks.after_frame(done, frame);
  };
  const RunResult run = play(slam, *opened.recording, watched);
  if (run.map_damage) throw InputError(*run.map_damage);

  SpeedMeasures measures = measures_of(run);
  measures.first_pose_seconds = first_pose_seconds;
  measures.wall_seconds = watch.seconds();
  measures.cpu_seconds = resource_usage().cpu_seconds - cpu_before;
  measures.instructions = instructions.count();
  if (is_reset) measures.peak_memory_mb = peak_memory_mb();
  return measures;
}

}  // namespace byre
