#include "byre/cli/draw/mission.h"

#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/run_with_progress.h"
#include "byre/features/image_threads.h"
#include "byre/input_error.h"
#include "byre/slam/system/option_table.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/core.h>

namespace byre::cli {
namespace {

// If only the camera picture is requested, the range ends with its frame.
FrameRange needed_range(const DrawOptions& options) {
  constexpr double kBeyond = 1e-6;  // seconds, as the end is exclusive
  FrameRange range = options.range;
  if (!options.at_s || options.plan_picture || options.video) return range;
  range.end_s = std::min(range.end_s.value_or(*options.at_s + kBeyond), *options.at_s + kBeyond);
  return range;
}

Slam make_slam(const DrawOptions& options, const Recording& recording) {
  SlamOptions slam_settings = slam_options(options.method.options());
  slam_settings.vocabulary = options.vocabulary;
  slam_settings.baseline = options.open.baseline;
  return Slam::on_map(recording.calibration(), options.map_file(), slam_settings);
}

MapScene online_scene(const MapGraph& mapped) {
  MapScene online = scene_of(mapped);
  for (ScenePoint& point : online.points) point.origin = Origin::online;
  for (SceneKeyframe& keyframe : online.keyframes) keyframe.origin = Origin::online;
  return online;
}

}  // namespace

DrawnMission draw_mission(const DrawOptions& options, const PlanScene& background) {
  const Timestamp first = open_recording(options.input, {}, options.open)->times().front();
  const std::unique_ptr<Recording> recording = open_recording(options.input, needed_range(options), options.open);
  if (options.at_s && first + from_seconds(*options.at_s) < recording->times().front()) {
    throw InputError(options.input.string(),
                     fmt::format("has no frame up to {:g} s in the selected range", *options.at_s),
                     "set an earlier --start or a later --at");
  }
  const MissionPainting painting{options.camera_picture.has_value(), options.at_s, options.video, options.speed,
                                 options.heights};
  MissionPainter painter(painting, *recording, first, background);
  PlayHooks hooks;
  hooks.on_frame = [&painter](const RunView& run) { painter.add(run); };
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  Slam slam = make_slam(options, *recording);
  RunResult run = play_with_progress(slam, *recording, hooks, interrupt, options.quiet);
  return {painter.finish(), online_scene(run.stored.map), std::move(run.warnings), interrupt.caught()};
}

}  // namespace byre::cli
