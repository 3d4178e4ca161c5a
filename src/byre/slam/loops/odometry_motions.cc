#include "byre/slam/loops/odometry_motions.h"

#include "byre/alignment.h"
#include "byre/slam/loops/loop_closing.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace byre {
namespace {

constexpr Timestamp kLongest = std::chrono::seconds(10);
constexpr Timestamp kLongestUnseen = std::chrono::minutes(2);

// Gate: sigmas of the measured motion, plus a share of the motion for errors of keyframes that are not adjusted yet. A
// focal length that errs by 20 % makes a turn in images err by as much before it is refined.
bool contradicts(const BodyMotion& measured, const Pose& seen) {
  constexpr double kSigmas = 5.0;
  constexpr double kShare = 0.3;
  const Vector6 error = log_pose(inverse(measured.last_from_body) * seen);
  const double way = std::sqrt(position_variance(measured.covariance));
  const double turn = std::sqrt(rotation_variance(measured.covariance));
  return error.head<3>().norm() > kSigmas * way + kShare * seen.translation.norm() ||
         error.tail<3>().norm() > kSigmas * turn + kShare * rotation_log(seen.rotation).norm();
}

int shared_points(const MapGraph& online, KeyframeId one, KeyframeId other) {
  for (const Covisible& seen : online.covisible_keyframes(one)) {
    if (seen.keyframe == other) return seen.shared_points;
  }
  return 0;
}

// Whether the images do not relate two keyframes: they share few points, or the later one was tracked from a keyframe
// that shares few points with the earlier one. In the second case a frame was relocalised at an old place displaced by
// drift, and the shared points were triangulated across the gap.
bool lacks_visual_constraint(const MapGraph& online, KeyframeId earlier, KeyframeId later) {
  constexpr int kFew = 30;
  if (shared_points(online, earlier, later) < kFew) return true;
  const auto tracked_from = online.living_ancestor(online.find_keyframe(later)->parent);
  return tracked_from && *tracked_from != earlier && shared_points(online, earlier, *tracked_from) < kFew;
}

Pose seen_between(const MapGraph& online, KeyframeId earlier, KeyframeId later) {
  const Keyframe &from = *online.find_keyframe(earlier), &to = *online.find_keyframe(later);
  return inverse(body_pose(rig_of(online, from), from.camera_from_world)) *
         body_pose(rig_of(online, to), to.camera_from_world);
}

}  // namespace

void LengthRatio::add(const BodyMotion& measured, const Pose& seen) {
  const Eigen::Vector3d& way = measured.last_from_body.translation;
  const double weight = 1.0 / position_variance(measured.covariance);
  ++count_;
  measured_squared_ += weight * way.squaredNorm();
  visual_by_measured_ += weight * seen.translation.dot(way);
}

std::optional<double> LengthRatio::value() const {
  return visual_by_measured_ > 0.0 ? std::optional(visual_by_measured_ / measured_squared_) : std::nullopt;
}

BodyMotion scale_motion(const BodyMotion& motion, double scale) {
  return {scale_lengths(motion.last_from_body, scale), scale_lengths(motion.covariance, scale)};
}

std::vector<KeyframeMotion> odometry_motions(const MapGraph& online, std::vector<KeyframeId> keyframes, int recording,
                                             const OdometryQuery& odometry) {
  std::vector<KeyframeMotion> motions;
  if (!odometry) return motions;
  std::erase_if(keyframes, [&](KeyframeId id) {
    const Keyframe* const keyframe = online.find_keyframe(id);
    return keyframe == nullptr || keyframe->recording != recording;
  });
  std::ranges::sort(keyframes);
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    const Keyframe& earlier = *online.find_keyframe(keyframes[i - 1]);
    const Keyframe& later = *online.find_keyframe(keyframes[i]);
    const Timestamp gap = later.frame.time - earlier.frame.time;
    if (gap > kLongestUnseen) continue;
    const bool unseen = lacks_visual_constraint(online, keyframes[i - 1], keyframes[i]);
    if (!unseen && (rig_of(online, later).is_stereo() || gap > kLongest)) continue;
    const auto measured = odometry(earlier.frame.time, later.frame.time);
    if (!measured) continue;
    if (unseen || !contradicts(*measured, seen_between(online, keyframes[i - 1], keyframes[i])))
      motions.push_back({keyframes[i - 1], keyframes[i], *measured, unseen});
  }
  return motions;
}

std::vector<KeyframeMotion> in_lengths_of(const MapGraph& online, std::vector<KeyframeMotion> motions) {
  constexpr std::size_t kMany = 20;
  if (motions.size() < kMany) return motions;
  LengthRatio ratio;
  for (const KeyframeMotion& motion : motions) {
    if (!motion.lacks_visual_constraint) ratio.add(motion.motion, seen_between(online, motion.earlier, motion.later));
  }
  if (!ratio.value()) return motions;
  for (KeyframeMotion& motion : motions) motion.motion = scale_motion(motion.motion, *ratio.value());
  return motions;
}

void add_motions(MapWindow& window, const std::vector<KeyframeMotion>& motions) {
  if (motions.empty()) return;
  std::map<KeyframeId, int> index_of;
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) index_of[window.keyframes[i].id] = static_cast<int>(i);
  for (const KeyframeMotion& motion : motions) {
    const auto earlier = index_of.find(motion.earlier), later = index_of.find(motion.later);
    if (earlier == index_of.end() || later == index_of.end()) continue;
    window.motions.push_back({earlier->second, later->second, motion.motion, motion.holds_scale});
  }
}

}  // namespace byre
