#include "byre/cli/draw/mission.h"

#include "byre/cli/shared/progress.h"
#include "byre/features/image_threads.h"
#include "byre/geometry/median.h"
#include "byre/input_error.h"
#include "byre/playback/play.h"
#include "byre/slam/system/option_table.h"
#include "byre/viewer/camera_picture.h"
#include "byre/viewer/run_video.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/core.h>

namespace byre::cli {
namespace {

constexpr double kHighestVideoRate = 30.0;  // Hz; above, frames are skipped

Timestamp median_step(const std::vector<Timestamp>& times) {
  std::vector<Timestamp> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  return median_or(std::move(steps), Timestamp(std::chrono::seconds(1)));
}

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

// Collects picture data and writes the video while a mission runs.
class MissionPainter {
 public:
  // first: time of the first frame of the whole recording. background: scene without the mission.
  MissionPainter(const DrawOptions& options, const Recording& recording, Timestamp first, const PlanScene& background);

  void add(const RunView& run);
  DrawnMission finish();

 private:
  void add_to_video(const FrameScene& frame, const Session& session);

  // Constant after construction.
  const DrawOptions& options_;
  const Timestamp first_;
  const FrameView view_;
  std::size_t offline_points_ = 0;
  PlanPictureOptions plan_options_;
  int every_ = 1;  // every n-th frame is filmed
  double video_rate_ = 1.0;

  PlanScene scene_;  // state after the last frame
  int frames_ = 0;
  std::optional<RunVideo> video_;
  DrawnMission mission_;
};

MissionPainter::MissionPainter(const DrawOptions& options, const Recording& recording, Timestamp first,
                               const PlanScene& background)
    : options_(options), first_(first), view_(recording.calibration()), scene_(background) {
  plan_options_.heights = options.heights;
  plan_options_.shown = shown_ground(scene_, options.heights);
  offline_points_ = scene_.map.points.size();
  const double frame_rate = options.speed / to_seconds(median_step(recording.times()));
  every_ = static_cast<int>(std::ceil(frame_rate / kHighestVideoRate));
  video_rate_ = frame_rate / every_;
  scene_.paths.emplace_back();
  mission_.rig = view_.rig();
}

void MissionPainter::add(const RunView& run) {
  const FrameReport& report = *run.frame.report;
  PlanPath& path = scene_.paths.back();
  if (report.map_from_body) {
    path.map_from_body.push_back({report.time, *report.map_from_body});
    path.verdicts.push_back(report.health.verdict);
  }
  const bool is_asked_for = options_.camera_picture || options_.at_s;
  const bool is_in_time = !options_.at_s || report.time <= first_ + from_seconds(*options_.at_s);
  const bool is_wanted = is_asked_for && is_in_time;
  const bool is_filmed = options_.video && frames_++ % every_ == 0;
  if (!is_wanted && !is_filmed) return;
  FrameScene frame = view_.scene_of(run.images.left, report, run.session.seen_points());
  if (is_filmed) add_to_video(frame, run.session);
  if (!is_wanted) return;
  mission_.frame_s = to_seconds(report.time - first_);
  mission_.frame = std::move(frame);
}

DrawnMission MissionPainter::finish() {
  mission_.path = std::move(scene_.paths.back());
  if (video_) video_->finish();
  return std::move(mission_);
}

void MissionPainter::add_to_video(const FrameScene& frame, const Session& session) {
  scene_.map.points.resize(offline_points_);
  std::ranges::move(scene_of(session.map().online()).points, std::back_inserter(scene_.map.points));
  scene_.camera.reset();
  if (frame.report.map_from_body) scene_.camera = plan_camera(*frame.report.map_from_body, view_.rig());
  CameraPictureOptions camera;
  camera.title = fmt::format("{:.2f} s", to_seconds(frame.report.time - first_));
  const Picture picture = frame_and_plan(frame, camera, scene_, plan_options_);
  if (!video_) video_.emplace(*options_.video, video_rate_, picture.width, picture.height);
  video_->add(picture);
  ++mission_.video_frames;
  mission_.plays_in_browsers = video_->plays_in_browsers();
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
  MissionPainter painter(options, *recording, first, background);
  PlayHooks hooks;
  hooks.on_frame = [&painter](const RunView& run) { painter.add(run); };
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  Slam slam = make_slam(options, *recording);
  RunResult run = play_with_progress(slam, *recording, hooks, interrupt, options.quiet);
  DrawnMission mission = painter.finish();
  mission.online = online_scene(run.stored.map);
  mission.warnings = std::move(run.warnings);
  mission.stopped = interrupt.caught();
  return mission;
}

}  // namespace byre::cli
