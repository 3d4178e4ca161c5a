#include "byre/mapping/anchored_trajectory.h"

#include "byre/alignment.h"
#include "byre/slam/body_pose.h"

#include <algorithm>

namespace byre {

Pose camera_from_world(const MapView& map, KeyframeId id) {
  return id.origin == Origin::offline ? map.offline()->camera_from_world(id) : map.online().camera_from_world(id);
}

Pose turn_of(const RigTurn& turn, KeyframeId id, const Map& online) {
  return id.origin == Origin::online && online.rig_of(id) == turn.rig ? turn.after_from_before : Pose{};
}

Pose camera_from_world(const MapView& map, const AnchoredPose& pose) {
  return pose.camera_from_keyframe * camera_from_world(map, pose.keyframe);
}

std::optional<Pose> AnchoredTrajectory::camera_at(Timestamp time, const MapView& map) const {
  const auto found = std::ranges::lower_bound(poses_, time, {}, &AnchoredPose::time);
  if (found == poses_.end() || found->time != time) return {};
  return byre::camera_from_world(map, *found);
}

Vector6 AnchoredTrajectory::velocity_to(Timestamp time, const Pose& camera_from_map, const MapView& map) const {
  const double elapsed = to_seconds(time - poses_.back().time);
  if (elapsed <= 0.0) return Vector6::Zero();
  return log_pose(camera_from_map * inverse(camera_from_world(map, poses_.back()))) / elapsed;
}

void AnchoredTrajectory::keep_sightings(const Rig& rig, const Features& features, const TrackedFrame& tracked) {
  hindsight_.note(poses_.size() - 1, rig, features, tracked);
}

void AnchoredTrajectory::anchor_last_to(KeyframeId keyframe) {
  poses_.back().keyframe = keyframe;
  poses_.back().camera_from_keyframe = Pose{};
  hindsight_.forget_from(poses_.size() - 1);
}

void AnchoredTrajectory::drop_doubtful() {
  poses_.resize(believed_end_);
  hindsight_.forget_from(believed_end_);
}

void AnchoredTrajectory::bend(std::size_t first, std::size_t second, const Pose& told, const MapView& map) {
  const Pose first_from_world = byre::camera_from_world(map, poses_[first]);
  const Pose seen = first_from_world * inverse(byre::camera_from_world(map, poses_[second]));
  const Pose correction = seen * inverse(told);
  const double seconds = to_seconds(poses_[second].time - poses_[first].time);
  for (std::size_t i = first + 1; i < second; ++i) {
    const double share = to_seconds(poses_[i].time - poses_[first].time) / seconds;
    const Pose camera_from_first = byre::camera_from_world(map, poses_[i]) * inverse(first_from_world);
    const Pose bent = camera_from_first * inverse(interpolate(Pose{}, correction, share)) * first_from_world;
    poses_[i].camera_from_keyframe = bent * inverse(byre::camera_from_world(map, poses_[i].keyframe));
  }
}

void AnchoredTrajectory::follow(const LengthChanges& changes) {
  for (AnchoredPose& pose : poses_) {
    const auto change = changes.find(pose.keyframe);
    if (change != changes.end()) pose.camera_from_keyframe = scale_lengths(pose.camera_from_keyframe, change->second);
  }
}

void AnchoredTrajectory::turn(const RigTurn& turn, const Map& online) {
  for (AnchoredPose& pose : poses_) {
    pose.camera_from_keyframe =
        turn.after_from_before * pose.camera_from_keyframe * inverse(turn_of(turn, pose.keyframe, online));
  }
}

void AnchoredTrajectory::turn_camera(const Pose& after_from_before) {
  hindsight_.turn_rig(after_from_before);
  for (AnchoredPose& pose : poses_) pose.camera_from_keyframe = after_from_before * pose.camera_from_keyframe;
}

void AnchoredTrajectory::settle_overdue(const MapView& map, const TrackOptions& tracking) {
  if (const auto overdue = hindsight_.take_overdue()) settle(*overdue, map, tracking);
}

void AnchoredTrajectory::settle_all(const MapView& map, const TrackOptions& tracking) {
  while (const auto seen = hindsight_.take_oldest()) settle(*seen, map, tracking);
}

// Mapping has settled by now where the points lie that the frame was tracked on.
void AnchoredTrajectory::settle(const RememberedFrame& seen, const MapView& map, const TrackOptions& tracking) {
  AnchoredPose& anchored = poses_[seen.number];
  const Pose keyframe_from_world = camera_from_world(map, anchored.keyframe);
  const auto pose = pose_in_hindsight(seen, anchored.camera_from_keyframe * keyframe_from_world, map, tracking);
  if (pose) anchored.camera_from_keyframe = *pose * inverse(keyframe_from_world);
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
