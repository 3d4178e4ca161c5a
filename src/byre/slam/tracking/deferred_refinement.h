#pragma once

#include "byre/slam/tracking/tracking.h"

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace byre {

struct DeferredRefinementOptions {
  std::size_t frames = 2000;  // maximum number that wait for the end, 10 kB each; older ones are settled earlier
};

// A point and its measurement in a frame.
struct DeferredPoint {
  PointId point;
  Eigen::Vector3f measured;  // u, v, disparity; pixels
  float pixel_sigma = 1.0f;
  float disparity_sigma = -1.0f;  // negative: no disparity
};

// A frame as it was tracked, with `rig`. Poses are of the present rig, turned by now_from_then.
struct DeferredFrame {
  std::size_t number = 0;  // number given by the caller
  Rig rig;
  Pose now_from_then;
  std::vector<DeferredPoint> points;
};

// Measurements of frames, kept until mapping has settled. A frame is tracked on points with few observations; once
// these are more precise, the pose of the frame is refined.
class DeferredRefinement {
 public:
  explicit DeferredRefinement(const DeferredRefinementOptions& options) : options_(options) {}

  // Numbers ascend. Skips frames with mostly offline inliers, since offline points do not move.
  void note(std::size_t number, const Rig& rig, const Features& features, const TrackedFrame& tracked);
  // Poses from here on are of another rig.
  void rotate_rig(const Pose& after_from_before);
  // Drops the frames from this number on.
  void forget_from(std::size_t number);

  std::optional<std::size_t> first() const;     // number of the oldest frame
  std::optional<DeferredFrame> take_overdue();  // the oldest frame, if more than options.frames wait
  std::optional<DeferredFrame> take_oldest();

 private:
  DeferredRefinementOptions options_;
  std::deque<DeferredFrame> frames_;
};

// Pose of the frame by the present positions of its points. Empty if too few are left or agree.
std::optional<Pose> refine_deferred_pose(const DeferredFrame& frame, const Pose& camera_from_world, const MapView& map,
                                         const TrackOptions& tracking);

}  // namespace byre
