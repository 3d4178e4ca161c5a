#pragma once

#include "byre/slam/tracking/tracking.h"

#include <cstddef>
#include <deque>
#include <map>
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

// Offline points and keyframes as a joint adjustment with the online map estimates them; the offline map is constant.
struct AdjustedOffline {
  std::map<PointId, Eigen::Vector3d> points_in_world;
  std::map<KeyframeId, Pose> camera_from_world;
};

// Measurements of frames, kept until mapping has settled. A frame is tracked on points with few observations; once
// these are more precise, the pose of the frame is refined.
class DeferredRefinement {
 public:
  explicit DeferredRefinement(const DeferredRefinementOptions& options) : options_(options) {}

  // Numbers ascend.
  void note(std::size_t number, const Rig& rig, const Features& features, const TrackedFrame& tracked);
  // Poses from here on are of another rig.
  void rotate_rig(const Pose& after_from_before);
  // Drops the frames from this number on.
  void forget_from(std::size_t number);

  std::optional<std::size_t> first() const;     // number of the oldest frame
  std::optional<DeferredFrame> take_overdue();  // the oldest frame, if more than options.frames wait
  std::optional<DeferredFrame> take_oldest();

 private:
  // A frame whose points are in a block.
  struct Kept {
    DeferredFrame frame;    // without points
    std::size_t block = 0;  // number of the block since the beginning
    std::size_t begin = 0;  // first point in it
    std::size_t end = 0;
  };

  DeferredRefinementOptions options_;
  std::vector<Kept> frames_;
  std::size_t taken_ = 0;  // frames at the front that were taken
  // Points of all frames, in blocks of fixed capacity, so that few frames allocate.
  std::deque<std::vector<DeferredPoint>> blocks_;
  std::size_t first_block_ = 0;  // number of the first of them
};

// Whether most points of the frame are offline ones.
bool is_held_by_offline(const DeferredFrame& frame);

// Pose of the frame by the present positions of its points; offline ones by `offline` if it has them. Empty if too few
// are left or agree.
std::optional<Pose> refine_deferred_pose(const DeferredFrame& frame, const Pose& camera_from_world, const MapView& map,
                                         const TrackOptions& tracking, const AdjustedOffline& offline = {});

}  // namespace byre
