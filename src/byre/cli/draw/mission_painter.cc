#include "byre/cli/draw/mission_painter.h"

#include "byre/geometry/median.h"
#include "byre/viewer/camera_picture.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

constexpr double kHighestVideoRate = 30.0;  // Hz; above, frames are skipped

Timestamp median_step(const std::vector<Timestamp>& times) {
  std::vector<Timestamp> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  return median_or(std::move(steps), Timestamp(std::chrono::seconds(1)));
}

}  // namespace

MissionPainter::MissionPainter(const MissionPainting& painting, const Recording& recording, Timestamp first,
                               const PlanScene& background)
    : painting_(painting), first_(first), view_(recording.calibration()), scene_(background) {
  plan_options_.heights = painting.heights;
  plan_options_.shown = shown_ground(scene_, painting.heights);
  offline_points_ = scene_.map.points.size();
  const double frame_rate = painting.speed / to_seconds(median_step(recording.times()));
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
  const bool is_asked_for = painting_.keep_frame || painting_.at_s;
  const bool is_in_time = !painting_.at_s || report.time <= first_ + from_seconds(*painting_.at_s);
  const bool is_wanted = is_asked_for && is_in_time;
  const bool is_filmed = painting_.video && frames_++ % every_ == 0;
  if (!is_wanted && !is_filmed) return;
  FrameScene frame = view_.scene_of(run.images.left, report, run.session.seen_points());
  if (is_filmed) add_to_video(frame, run.session);
  if (!is_wanted) return;
  mission_.frame_s = to_seconds(report.time - first_);
  mission_.frame = std::move(frame);
}

PaintedMission MissionPainter::finish() {
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
  if (!video_) video_.emplace(*painting_.video, video_rate_, picture.width, picture.height);
  video_->add(picture);
  ++mission_.video_frames;
  mission_.plays_in_browsers = video_->plays_in_browsers();
}

}  // namespace byre
