#pragma once

#include "byre/map/map_view.h"
#include "byre/slam/loops/global_mapping.h"
#include "byre/slam/mapping/submaps.h"
#include "byre/slam/tracking/deferred_refinement.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace byre {

// Current pose of a keyframe of either map; also of a removed one.
Pose camera_from_world(const MapView& map, KeyframeId id);

// Change of a rig's rectified camera by a new calibration.
struct RigRotation {
  Pose after_from_before;
  int rig = 0;  // index into MapGraph::rigs
  Rig after;
};

// Rotation of an online keyframe's camera; identity for keyframes of other rigs.
Pose rotation_of(const RigRotation& turn, KeyframeId id, const MapGraph& online);

// Pose of a frame relative to a keyframe, so that it follows when mapping moves the keyframe.
struct AnchoredPose {
  Timestamp time{};
  KeyframeId keyframe;
  Pose camera_from_keyframe;
  std::size_t submap = 0;
};

Pose camera_from_world(const MapView& map, const AnchoredPose& pose);

struct TrajectoryOptions {
  std::size_t max_poses = 0;  // largest number of poses; 0: unlimited. Thins out older poses evenly
};

// One pose per frame that had one, by time. The last ones may be unconfirmed.
class AnchoredTrajectory {
 public:
  explicit AnchoredTrajectory(const DeferredRefinementOptions& deferred_refinement,
                              const TrajectoryOptions& options = {})
      : options_(options), deferred_(deferred_refinement) {}

  bool empty() const { return poses_.empty(); }
  std::size_t size() const { return poses_.size(); }
  const AnchoredPose& back() const { return poses_.back(); }
  const AnchoredPose& operator[](std::size_t number) const { return poses_[number]; }
  const AnchoredPose* find(Timestamp time) const;  // null if the frame has no pose or it was thinned out
  // Camera pose at a frame; empty if find() is null.
  std::optional<Pose> camera_at(Timestamp time, const MapView& map) const;
  // The camera's velocity from the last pose to a pose at a later time, see MotionModel; zero if no time elapsed.
  Vector6 velocity_to(Timestamp time, const Pose& camera_from_map, const MapView& map) const;
  bool has_unconfirmed() const { return poses_.size() > confirmed_end_; }

  void add(const AnchoredPose& pose) { poses_.push_back(pose); }
  // Keeps the last frame's sightings, to refine its pose once mapping has settled.
  void keep_sightings(const Rig& rig, const Features& features, const TrackedFrame& tracked);
  // Poses after a time belong to another submap.
  void move_to_submap(std::size_t submap, Timestamp after);
  // The last frame became this keyframe.
  void anchor_last_to(KeyframeId keyframe);
  std::size_t confirmed_count() const { return confirmed_end_; }  // number of confirmed poses, the first ones
  void confirm_all() { confirmed_end_ = poses_.size(); }
  void drop_unconfirmed();

  // Distributes the error of dead reckoning over the poses between two measured ones, in proportion to time. measured:
  // first_from_second of the camera, by odometry.
  void distribute_drift(std::size_t first, std::size_t second, const Pose& measured, const MapView& map);

  // With more than options.max_poses poses, thins out those before the newest half, but none from index end on. Returns
  // the number of removed poses, by which the indices of later ones decrease.
  std::size_t thin_out(std::size_t end);

  // Rescales poses relative to keyframes whose lengths changed.
  void apply_length_changes(const LengthChanges& changes);
  // A new calibration rotated the cameras of a rig, those of its keyframes too.
  void rotate_rig(const RigRotation& turn, const MapGraph& online);
  // The camera of all poses changes; keyframes keep theirs.
  void rotate_camera(const Pose& after_from_before);

  // Refines the oldest pose whose sightings were kept long enough, or all remaining ones. Poses relative to offline
  // keyframes follow the adjusted ones.
  void refine_overdue(const MapView& map, const TrackOptions& tracking);
  void refine_all_deferred(const MapView& map, const TrackOptions& tracking, const AdjustedOffline& offline);

  // Times of the poses in other frames than the map frame.
  std::vector<Timestamp> times_outside_map_frame(const Submaps& submaps) const;
  // The poses world_from_body in the map frame.
  Trajectory in_map_frame(const MapView& map, const Submaps& submaps, const Rig& rig) const;

 private:
  void refine_deferred(const DeferredFrame& seen, const MapView& map, const TrackOptions& tracking,
                       const AdjustedOffline& offline);
  std::size_t number_of(std::size_t index) const { return index + thinned_out_; }
  std::size_t recent_begin() const;

  TrajectoryOptions options_;  // constant after construction
  std::vector<AnchoredPose> poses_;
  std::size_t confirmed_end_ = 0;                       // poses before this index are confirmed
  Timestamp spacing_ = std::chrono::milliseconds(100);  // least time between poses after thinning out
  std::size_t thinned_out_ = 0;                         // number of poses removed so far
  DeferredRefinement deferred_;                         // by index as if no pose had been removed
};

}  // namespace byre
