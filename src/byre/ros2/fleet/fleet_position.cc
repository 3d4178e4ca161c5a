#include "byre/ros2/fleet/fleet_position.h"

#include "byre/slam/frame/health.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace byre {
namespace {

constexpr Timestamp kMaxSilence = std::chrono::seconds(3);  // time without frames after which the position is invalid
constexpr double kMaxDegraded = 0.4;
constexpr double kUntrusted = 0.1;

std::string problem_of(const FrameReport& report) {
  const Health& health = report.health;
  if (health.verdict == Verdict::trusted) return "";
  return std::string(to_string(health.verdict)).append(": ").append(to_string(health.doubt));
}

}  // namespace

double localization_score(const FrameReport& report) {
  if (!report.map_from_body) return 0.0;
  if (report.health.verdict == Verdict::untrusted) return kUntrusted;
  const HealthOptions options;
  const double taken_up = position_error(report.health, options) / options.trusted_error;
  const double score = 1.0 - 0.5 * std::clamp(taken_up, 0.0, 1.0);
  return report.health.verdict == Verdict::trusted ? score : std::min(score, kMaxDegraded);
}

void FleetPositionKeeper::note(const FrameReport& report, Timestamp arrived, const std::string& advice) {
  const bool is_usable = report.map_from_body && report.health.verdict != Verdict::untrusted;
  position_.score = localization_score(report);
  position_.problem = problem_of(report);
  position_.advice = advice;
  position_.deviation.reset();
  if (is_usable) {
    const Eigen::Vector3d ahead = report.map_from_body->rotation * Eigen::Vector3d::UnitX();
    position_.x = report.map_from_body->translation.x();
    position_.y = report.map_from_body->translation.y();
    position_.theta = std::atan2(ahead.y(), ahead.x());
    position_.deviation = position_error(report.health, {});
    if (report.health.verdict == Verdict::trusted) position_.is_initialised = true;
  }
  if (report.state == State::lost || report.has(SessionEvent::navigation_error)) position_.is_initialised = false;

  position_.velocity.reset();
  if (report.odometry_from_body && odometry_ && report.time > odometry_->time) {
    const double seconds = to_seconds(report.time - odometry_->time);
    const Pose motion = inverse(odometry_->odometry_from_body) * *report.odometry_from_body;
    position_.velocity = FleetVelocity{motion.translation.x() / seconds, motion.translation.y() / seconds,
                                       rotation_log(motion.rotation).z() / seconds};
  }
  odometry_.reset();
  if (report.odometry_from_body) odometry_ = Odometry{report.time, *report.odometry_from_body};
  arrived_ = arrived;
}

void FleetPositionKeeper::restart() {
  position_.is_initialised = false;
  odometry_.reset();
}

FleetPosition FleetPositionKeeper::at(Timestamp now) const {
  FleetPosition position = position_;
  if (arrived_ && now - *arrived_ <= kMaxSilence) return position;
  position.is_initialised = false;
  position.score = 0.0;
  position.deviation.reset();
  position.velocity.reset();
  position.problem = arrived_ ? "no images arrive" : "no image has been tracked yet";
  position.advice = "check the camera and its driver";
  return position;
}

}  // namespace byre
