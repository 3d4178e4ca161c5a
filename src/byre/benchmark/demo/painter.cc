#include "byre/benchmark/demo/painter.h"

#include "byre/viewer/camera_picture.h"

#include <algorithm>
#include <iterator>

#include <fmt/core.h>

namespace byre {

void DemoPainter::add(const RunView& run) {
  const FrameReport& report = *run.frame.report;
  if (!first_) first_ = report.time;
  online_ = scene_of(run.session.map().online());
  if (every_for_film_ > 0 && frames_++ % every_for_film_ == 0) {
    film_.push_back(view_.scene_of(run.images.left, report, run.session.seen_points()));
  }
  if (!report.map_from_body) return;
  path_.map_from_body.push_back({report.time, *report.map_from_body});
  path_.verdicts.push_back(report.health.verdict);
  const int points = std::min(report.health.offline_inliers, report.health.online_inliers);
  if (points <= best_points_) return;
  best_points_ = points;
  best_ = view_.scene_of(run.images.left, report, run.session.seen_points());
}

std::optional<double> DemoPainter::camera_s() const {
  if (!best_) return std::nullopt;
  return to_seconds(best_->report.time - *first_);
}

std::string DemoPainter::plan_picture(PlanScene background) const {
  std::ranges::copy(online_.points, std::back_inserter(background.map.points));
  std::ranges::copy(online_.keyframes, std::back_inserter(background.map.keyframes));
  background.paths.push_back(path_);
  background.paths.back().name = "second visit, hybrid";
  if (best_) background.camera = plan_camera(*best_->report.map_from_body, view_.rig());
  return to_svg(byre::plan_picture(background));
}

std::string DemoPainter::camera_picture() const {
  CameraPictureOptions options;
  options.title = fmt::format("{:.1f} s", *camera_s());
  return to_svg(byre::camera_picture(*best_, options));
}

}  // namespace byre
