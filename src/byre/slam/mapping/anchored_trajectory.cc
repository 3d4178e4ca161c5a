#include "byre/slam/mapping/anchored_trajectory.h"

#include "byre/alignment.h"
#include "byre/slam/tracking/body_pose.h"

#include <algorithm>

namespace byre {

Pose camera_from_world(const MapView& map, KeyframeId id) {
  return id.origin == Origin::offline ? map.offline()->camera_from_world(id) : map.online().camera_from_world(id);
}

Pose rotation_of(const RigRotation& turn, KeyframeId id, const MapGraph& online) {
  return id.origin == Origin::online && online.rig_of(id) == turn.rig ? turn.after_from_before : Pose{};
}

Pose camera_from_world(const MapView& map, const AnchoredPose& pose) {
  return pose.camera_from_keyframe * camera_from_world(map, pose.keyframe);
}

const AnchoredPose* AnchoredTrajectory::find(Timestamp time) const {
  const auto found = std::ranges::lower_bound(poses_, time, {}, &AnchoredPose::time);
  return found == poses_.end() || found->time != time ? nullptr : &*found;
}

std::optional<Pose> AnchoredTrajectory::camera_at(Timestamp time, const MapView& map) const {
  const AnchoredPose* const pose = find(time);
  return pose == nullptr ? std::nullopt : std::optional(byre::camera_from_world(map, *pose));
}

Vector6 AnchoredTrajectory::velocity_to(Timestamp time, const Pose& camera_from_map, const MapView& map) const {
  const double elapsed = to_seconds(time - poses_.back().time);
  if (elapsed <= 0.0) return Vector6::Zero();
  return log_pose(camera_from_map * inverse(camera_from_world(map, poses_.back()))) / elapsed;
}

void AnchoredTrajectory::keep_sightings(const Rig& rig, const Features& features, const TrackedFrame& tracked) {
  deferred_.note(number_of(poses_.size() - 1), rig, features, tracked);
}

void AnchoredTrajectory::move_to_submap(std::size_t submap, Timestamp after) {
  for (auto pose = poses_.rbegin(); pose != poses_.rend() && pose->time > after; ++pose) pose->submap = submap;
}

void AnchoredTrajectory::anchor_last_to(KeyframeId keyframe) {
  poses_.back().keyframe = keyframe;
  poses_.back().camera_from_keyframe = Pose{};
  deferred_.forget_from(number_of(poses_.size() - 1));
}

void AnchoredTrajectory::drop_unconfirmed() {
  poses_.resize(confirmed_end_);
  deferred_.forget_from(number_of(confirmed_end_));
}

void AnchoredTrajectory::distribute_drift(std::size_t first, std::size_t second, const Pose& measured,
                                          const MapView& map) {
  const Pose first_from_world = byre::camera_from_world(map, poses_[first]);
  const Pose seen = first_from_world * inverse(byre::camera_from_world(map, poses_[second]));
  const Pose correction = seen * inverse(measured);
  const double seconds = to_seconds(poses_[second].time - poses_[first].time);
  for (std::size_t i = first + 1; i < second; ++i) {
    const double share = to_seconds(poses_[i].time - poses_[first].time) / seconds;
    const Pose camera_from_first = byre::camera_from_world(map, poses_[i]) * inverse(first_from_world);
    const Pose corrected = camera_from_first * inverse(interpolate(Pose{}, correction, share)) * first_from_world;
    poses_[i].camera_from_keyframe = corrected * inverse(byre::camera_from_world(map, poses_[i].keyframe));
  }
}

// Index of the first pose that is never thinned out.
std::size_t AnchoredTrajectory::recent_begin() const {
  const std::size_t recent = options_.max_poses / 2;
  return options_.max_poses == 0 || poses_.size() < recent ? 0 : poses_.size() - recent;
}

std::size_t AnchoredTrajectory::thin_out(std::size_t end) {
  if (options_.max_poses == 0 || poses_.size() <= options_.max_poses) return 0;
  end = std::min({end, confirmed_end_, recent_begin()});
  if (const auto first = deferred_.first()) end = std::min(end, *first - thinned_out_);
  const std::size_t most = std::max<std::size_t>(options_.max_poses / 4, 1);
  if (end <= most) return 0;
  const auto begin = poses_.begin(), middle = begin + static_cast<std::ptrdiff_t>(end);
  const auto thin = [&](auto until) {
    return std::unique(begin, until, [this](const AnchoredPose& kept, const AnchoredPose& next) {
      return next.time - kept.time < spacing_;
    });
  };
  auto kept = thin(middle);
  for (; kept - begin > static_cast<std::ptrdiff_t>(most); kept = thin(kept)) spacing_ *= 2;
  const auto removed = static_cast<std::size_t>(middle - kept);
  poses_.erase(kept, middle);
  confirmed_end_ -= removed;
  thinned_out_ += removed;
  return removed;
}

void AnchoredTrajectory::apply_length_changes(const LengthChanges& changes) {
  for (AnchoredPose& pose : poses_) {
    const auto change = changes.find(pose.keyframe);
    if (change != changes.end()) pose.camera_from_keyframe = scale_lengths(pose.camera_from_keyframe, change->second);
  }
}

void AnchoredTrajectory::rotate_rig(const RigRotation& turn, const MapGraph& online) {
  for (AnchoredPose& pose : poses_) {
    pose.camera_from_keyframe =
        turn.after_from_before * pose.camera_from_keyframe * inverse(rotation_of(turn, pose.keyframe, online));
  }
}

void AnchoredTrajectory::rotate_camera(const Pose& after_from_before) {
  deferred_.rotate_rig(after_from_before);
  for (AnchoredPose& pose : poses_) pose.camera_from_keyframe = after_from_before * pose.camera_from_keyframe;
}

void AnchoredTrajectory::refine_overdue(const MapView& map, const TrackOptions& tracking) {
  const auto first = deferred_.first();
  const bool is_old = first && *first < number_of(recent_begin());
  if (const auto overdue = is_old ? deferred_.take_oldest() : deferred_.take_overdue()) {
    refine_deferred(*overdue, map, tracking, {});
  }
}

void AnchoredTrajectory::refine_all_deferred(const MapView& map, const TrackOptions& tracking,
                                             const AdjustedOffline& offline) {
  for (AnchoredPose& pose : poses_) {
    const auto adjusted = offline.camera_from_world.find(pose.keyframe);
    if (adjusted == offline.camera_from_world.end()) continue;
    pose.camera_from_keyframe =
        pose.camera_from_keyframe * adjusted->second * inverse(camera_from_world(map, pose.keyframe));
  }
  while (const auto seen = deferred_.take_oldest()) refine_deferred(*seen, map, tracking, offline);
}

// Precondition: mapping has settled the points on which the frame was tracked.
void AnchoredTrajectory::refine_deferred(const DeferredFrame& seen, const MapView& map, const TrackOptions& tracking,
                                         const AdjustedOffline& offline) {
  if (offline.points_in_world.empty() && is_held_by_offline(seen)) return;  // its points did not move
  AnchoredPose& anchored = poses_[seen.number - thinned_out_];
  const Pose keyframe_from_world = camera_from_world(map, anchored.keyframe);
  const auto pose =
      refine_deferred_pose(seen, anchored.camera_from_keyframe * keyframe_from_world, map, tracking, offline);
  if (pose) anchored.camera_from_keyframe = *pose * inverse(keyframe_from_world);
}

std::vector<Timestamp> AnchoredTrajectory::times_outside_map_frame(const Submaps& submaps) const {
  std::vector<Timestamp> times;
  for (const AnchoredPose& pose : poses_) {
    if (submaps.frame(pose.submap) != Submaps::kMapFrame) times.push_back(pose.time);
  }
  return times;
}

Trajectory AnchoredTrajectory::in_map_frame(const MapView& map, const Submaps& submaps, const Rig& rig) const {
  Trajectory trajectory;
  trajectory.reserve(poses_.size());
  for (const AnchoredPose& pose : poses_) {
    if (submaps.frame(pose.submap) != Submaps::kMapFrame) continue;
    trajectory.push_back({pose.time, body_pose(rig, camera_from_world(map, pose))});
  }
  return trajectory;
}

}  // namespace byre
