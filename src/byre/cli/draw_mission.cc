#include "byre/cli/draw_mission.h"

#include "byre/cli/formatted.h"
#include "byre/cli/run_with_progress.h"
#include "byre/features/image_threads.h"
#include "byre/input_error.h"
#include "byre/place/map_words.h"
#include "byre/playback/map_run.h"
#include "byre/system/stored_map.h"
#include "byre/viewer/frame_view.h"
#include "byre/viewer/run_video.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace byre::cli {
namespace {

constexpr double kHighestFrameRate = 30.0;  // of videos, Hz: of more frames some are left out

Timestamp median_step(const std::vector<Timestamp>& times) {
  std::vector<Timestamp> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return from_seconds(1.0);
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  return steps[steps.size() / 2];
}

// Looks at each frame of a run, and keeps and draws what was asked for.
class MissionPainter {
 public:
  MissionPainter(const DrawOptions& options, const Recording& recording, Timestamp first, const PlanScene& background)
      : options_(options), first_(first), view_(recording.calibration()), scene_(background) {
    if (options.at_s) at_ = first + from_seconds(*options.at_s);
    plan_options_.heights = options.heights;
    plan_options_.shown = shown_ground(scene_, options.heights);
    offline_points_ = scene_.map.points.size();
    const double frame_rate = options.speed / to_seconds(median_step(recording.times()));
    every_ = static_cast<int>(std::ceil(frame_rate / kHighestFrameRate));
    video_rate_ = frame_rate / every_;
    scene_.paths.emplace_back();
    mission_.rig = view_.rig();
  }

  void look(const RunView& run) {
    const FrameReport& report = *run.frame.report;
    PlanPath& way = scene_.paths.back();
    if (report.map_from_body) {
      way.map_from_body.push_back({report.time, *report.map_from_body});
      way.verdicts.push_back(report.health.verdict);
    }
    const bool is_asked_for = options_.camera_picture || options_.at_s;
    const bool is_wanted = is_asked_for && (!at_ || report.time <= *at_);
    const bool is_filmed = options_.video && frames_++ % every_ == 0;
    if (!is_wanted && !is_filmed) return;
    FrameScene frame = view_.scene_of(run.images.left, report, run.session.seen_points());
    if (is_filmed) film(frame, run.session);
    if (!is_wanted) return;
    mission_.frame_s = to_seconds(report.time - first_);
    mission_.frame = std::move(frame);
  }

  DrawnMission finish() {
    mission_.way = std::move(scene_.paths.back());
    return std::move(mission_);
  }

 private:
  void film(const FrameScene& frame, const Session& session) {
    scene_.map.points.resize(offline_points_);
    std::ranges::move(scene_of(session.map().online()).points, std::back_inserter(scene_.map.points));
    scene_.camera.reset();
    if (frame.report.map_from_body) scene_.camera = plan_camera(*frame.report.map_from_body, view_.rig());
    CameraPictureOptions camera;
    camera.title = formatted("%.2f s", to_seconds(frame.report.time - first_));
    const Picture picture = frame_and_plan(frame, camera, scene_, plan_options_);
    if (!video_) video_.emplace(*options_.video, video_rate_, picture.width, picture.height);
    video_->add(picture);
    ++mission_.video_frames;
    mission_.plays_in_browsers = video_->plays_in_browsers();
  }

  const DrawOptions& options_;
  Timestamp first_;  // of the recording
  std::optional<Timestamp> at_;
  FrameView view_;
  PlanScene scene_;  // as after the last frame
  PlanPictureOptions plan_options_;
  std::size_t offline_points_ = 0;
  int every_ = 1;  // of so many frames one is filmed
  double video_rate_ = 1.0;
  int frames_ = 0;
  std::optional<RunVideo> video_;
  DrawnMission mission_;
};

// Nothing after the moment of the camera picture is needed for that one alone.
FrameRange needed_range(const DrawOptions& options) {
  constexpr double kBeyond = 1e-6;  // seconds: the end is exclusive
  FrameRange range = options.range;
  if (!options.at_s || options.plan_picture || options.video) return range;
  range.end_s = std::min(range.end_s.value_or(*options.at_s + kBeyond), *options.at_s + kBeyond);
  return range;
}

EngineOptions run_options(const DrawOptions& options, StoredMap stored) {
  EngineOptions run;
  run.vocabulary = open_vocabulary(options.vocabulary);
  add_words(stored, *run.vocabulary);
  run.offline = std::make_shared<const OfflineMap>(std::move(stored.map), *run.vocabulary);
  return run;
}

MapScene scene_beside(const Map& mapped) {
  MapScene online = scene_of(mapped);
  for (ScenePoint& point : online.points) point.origin = Origin::online;
  for (SceneKeyframe& keyframe : online.keyframes) keyframe.origin = Origin::online;
  return online;
}

}  // namespace

DrawnMission draw_mission(const DrawOptions& options, StoredMap stored, const PlanScene& background) {
  const Timestamp first = open_recording(options.input, {}, options.open)->times().front();
  const std::unique_ptr<Recording> recording = open_recording(options.input, needed_range(options), options.open);
  if (options.at_s && first + from_seconds(*options.at_s) < recording->times().front()) {
    throw InputError(options.input.string(), formatted("has no frame up to %g s in the range to run", *options.at_s),
                     "start earlier, or have --at later");
  }
  MissionPainter painter(options, *recording, first, background);
  MapRunHooks hooks;
  hooks.look = [&painter](const RunView& run) { painter.look(run); };
  limit_image_threads(1);
  const InterruptCatcher interrupt(options.outputs());
  MapRun run = run_with_progress(*recording, run_options(options, std::move(stored)), hooks, interrupt, options.quiet);
  DrawnMission mission = painter.finish();
  mission.online = scene_beside(run.map);
  mission.warnings = std::move(run.warnings);
  mission.stopped = interrupt.caught();
  return mission;
}

}  // namespace byre::cli
