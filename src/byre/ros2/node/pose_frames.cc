#include "byre/ros2/node/pose_frames.h"

#include <utility>

namespace byre {

void PoseFrames::restart() {
  odom_from_start_.reset();
  odom_from_base_.reset();
  map_from_odom_.reset();
  is_held_ = false;
}

void PoseFrames::note(const FrameReport& report) {
  if (!std::exchange(is_odometry_own_, true)) map_from_odom_.reset();  // to another odom frame
  note_odometry(report);
  update(report, odom_from_base_);
}

void PoseFrames::note(const FrameReport& report, const std::optional<Pose>& odom_from_base_of_owner) {
  if (std::exchange(is_odometry_own_, false)) map_from_odom_.reset();
  note_odometry(report);
  update(report, odom_from_base_of_owner);
}

void PoseFrames::note_odometry(const FrameReport& report) {
  odom_from_base_.reset();
  if (!report.odometry_from_body) return;
  const Pose& start_from_base = *report.odometry_from_body;
  if (!odom_from_start_) odom_from_start_ = last_odom_from_base_ * inverse(start_from_base);
  last_odom_from_base_ = *odom_from_start_ * start_from_base;
  odom_from_base_ = last_odom_from_base_;
}

void PoseFrames::update(const FrameReport& report, const std::optional<Pose>& odom_from_base) {
  const bool is_known = report.map_from_body && odom_from_base && report.health.verdict != Verdict::untrusted;
  if (is_known) map_from_odom_ = *report.map_from_body * inverse(*odom_from_base);
  if (report.state == State::lost || report.has(SessionEvent::navigation_error)) map_from_odom_.reset();
  is_held_ = !is_known && map_from_odom_.has_value();
}

}  // namespace byre
