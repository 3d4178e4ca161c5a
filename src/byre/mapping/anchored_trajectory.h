#pragma once

#include "byre/map/map_view.h"
#include "byre/mapping/submaps.h"
#include "byre/slam/global_mapping.h"
#include "byre/slam/hindsight.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace byre {

// The pose of a keyframe now, in either map, of a removed one too.
Pose camera_from_world(const MapView& map, KeyframeId id);

// The rectified camera of one rig, as another calibration has it.
struct RigTurn {
  Pose after_from_before;
  int rig = 0;  // index into Map::rigs
  Rig after;
};

// How the camera of an online keyframe was turned: not at all where it is of another rig.
Pose turn_of(const RigTurn& turn, KeyframeId id, const Map& online);

// Where a frame lay relative to a keyframe, so that it moves along when mapping moves that one.
struct AnchoredPose {
  Timestamp time{};
  KeyframeId keyframe;
  Pose camera_from_keyframe;
  std::size_t submap = 0;
};

Pose camera_from_world(const MapView& map, const AnchoredPose& pose);

struct TrajectoryOptions {
  std::size_t max_poses = 0;  // most poses that are kept; 0: all. Newer ones all, older ones evenly thinned out
};

// One pose for each frame that had one, in order of time. The last of them may not be believed yet.
class AnchoredTrajectory {
 public:
  explicit AnchoredTrajectory(const HindsightOptions& hindsight, const TrajectoryOptions& options = {})
      : options_(options), hindsight_(hindsight) {}

  bool empty() const { return poses_.empty(); }
  std::size_t size() const { return poses_.size(); }
  const AnchoredPose& back() const { return poses_.back(); }
  const AnchoredPose& operator[](std::size_t number) const { return poses_[number]; }
  const AnchoredPose* find(Timestamp time) const;  // null for a frame that had no pose, or whose pose was left out
  // The camera at a frame that had a pose then; empty for any other.
  std::optional<Pose> camera_at(Timestamp time, const MapView& map) const;
  // The camera's velocity from the last pose to one at a later time, see MotionModel; zero where no time went by.
  Vector6 velocity_to(Timestamp time, const Pose& camera_from_map, const MapView& map) const;
  bool ends_in_doubt() const { return poses_.size() > believed_end_; }

  void add(const AnchoredPose& pose) { poses_.push_back(pose); }
  // What the last frame saw is kept, to refine its pose once mapping has settled.
  void keep_sightings(const Rig& rig, const Features& features, const TrackedFrame& tracked);
  // The last frame has become a keyframe.
  void anchor_last_to(KeyframeId keyframe);
  std::size_t believed_count() const { return believed_end_; }  // so many of the first are believed
  void believe_all() { believed_end_ = poses_.size(); }
  void drop_doubtful();

  // The poses between two were led on from the first by what was told, and the second, seen again, is not where that
  // led to: each takes its share, by time, of what the way was told wrongly. told: first_from_second, of the camera.
  void bend(std::size_t first, std::size_t second, const Pose& told, const MapView& map);

  // Where there are more poses than options say, leaves out some of those before the last half of that number, but none
  // from index end on. Returns how many: indices of all later poses become less by that.
  std::size_t thin_out(std::size_t end);

  // What was measured relative to keyframes, in lengths that have changed since.
  void follow(const LengthChanges& changes);
  // The cameras of a rig were turned, and those of its keyframes with them.
  void turn(const RigTurn& turn, const Map& online);
  // The camera is another one from here on; keyframes stay as they are.
  void turn_camera(const Pose& after_from_before);

  // Refines the pose of the oldest frame whose sightings have been kept long enough, and of all that are left.
  void settle_overdue(const MapView& map, const TrackOptions& tracking);
  void settle_all(const MapView& map, const TrackOptions& tracking);

  // The poses in the reports' frame. world_from_body.
  Trajectory in_map_frame(const MapView& map, const Submaps& submaps, const Rig& rig) const;

 private:
  void settle(const RememberedFrame& seen, const MapView& map, const TrackOptions& tracking);
  std::size_t number_of(std::size_t index) const { return index + thinned_out_; }
  std::size_t recent_begin() const;

  TrajectoryOptions options_;  // constant after construction
  std::vector<AnchoredPose> poses_;
  std::size_t believed_end_ = 0;                        // poses before are believed
  Timestamp spacing_ = std::chrono::milliseconds(100);  // least time between poses that were thinned out
  std::size_t thinned_out_ = 0;                         // poses left out so far
  Hindsight hindsight_;                                 // numbers are indices into the poses, had none been left out
};

}  // namespace byre
