#include "byre/io/recording/wheel_stream.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr double kRestSpeed = 1e-3;                            // metres, or radians, per second
constexpr double kMinMotion = 0.05;                            // metres, or radians
constexpr Timestamp kMaxGap = std::chrono::milliseconds(300);  // largest gap between integrated velocities

bool is_at_rest(const std::optional<BaseTwist>& velocity) {
  return !velocity || (std::hypot(velocity->vx, velocity->vy) < kRestSpeed && std::abs(velocity->wz) < kRestSpeed);
}

bool is_same(const Pose& one, const Pose& other) {
  return one.translation == other.translation && one.rotation.coeffs() == other.rotation.coeffs();
}

}  // namespace

// Integrates velocities with their sign, so that noise at rest does not add up to motion.
bool WheelStream::accumulate_motion(const WheelSample& sample) {
  if (!sample.velocity) return false;
  const BaseTwist& now = *sample.velocity;
  if (last_ && now.time > last_->time && now.time - last_->time <= kMaxGap) {
    const Eigen::Vector3d sum(last_->vx + now.vx, last_->vy + now.vy, last_->wz + now.wz);
    moved_ += 0.5 * to_seconds(now.time - last_->time) * sum;
  }
  last_ = now;
  return moved_.head<2>().norm() > kMinMotion || std::abs(moved_.z()) > kMinMotion;
}

void WheelStream::emit(const WheelSample& sample) {
  if (kind_ == Kind::velocities) {
    if (sample.velocity) output_.push_back({sample.time, {}, sample.velocity});
  } else if (sample.pose) {
    output_.push_back({sample.time, sample.pose, {}});
  }
}

void WheelStream::decide(Kind kind) {
  kind_ = kind;
  for (const WheelSample& sample : std::exchange(pending_, {})) emit(sample);
}

void WheelStream::add(const WheelSample& sample) {
  if (sample.pose && !first_) first_ = sample.pose;
  const bool has_pose_changed = sample.pose && !is_same(*sample.pose, *first_);
  if (has_pose_changed && kind_ != Kind::poses) decide(Kind::poses);
  if (kind_ != Kind::open) return emit(sample);
  const bool has_moved = accumulate_motion(sample);
  if (pending_.empty() && sample.pose && is_at_rest(sample.velocity)) return emit(sample);
  pending_.push_back(sample);
  if (has_moved || !sample.pose) decide(Kind::velocities);
}

std::vector<WheelSample> WheelStream::take() {
  return std::exchange(output_, {});
}

}  // namespace byre
