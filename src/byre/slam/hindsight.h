#pragma once

#include "byre/slam/tracking.h"

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace byre {

struct HindsightOptions {
  std::size_t frames = 2000;  // most frames that wait for the end, 10 kB each; older ones are settled earlier
};

// A point and where a frame saw it.
struct RememberedPoint {
  PointId point;
  Eigen::Vector3f measured;  // u, v, disparity; pixels
  float pixel_sigma = 1.0f;
  float disparity_sigma = -1.0f;  // negative: no disparity
};

// Measured with the rig there was; where the camera stands is told of the rig there is now.
struct RememberedFrame {
  std::size_t number = 0;  // the caller's
  Rig rig;
  Pose now_from_then;
  std::vector<RememberedPoint> points;
};

// What frames saw, kept until mapping has settled it. A frame is tracked on points that were seen a few times only; at
// the end they are known much better, and so is where the frame was taken from.
class Hindsight {
 public:
  explicit Hindsight(const HindsightOptions& options) : options_(options) {}

  // A frame of a higher number than any before. Not kept where mostly offline points hold it, which stay where they
  // are.
  void note(std::size_t number, const Rig& rig, const Features& features, const TrackedFrame& tracked);
  // From here on poses are of another rig.
  void turn_rig(const Pose& after_from_before);
  // Frames from this number on are not to be looked at again.
  void forget_from(std::size_t number);

  std::optional<std::size_t> first() const;       // number of the oldest frame
  std::optional<RememberedFrame> take_overdue();  // the oldest, where more wait than options say
  std::optional<RememberedFrame> take_oldest();

 private:
  HindsightOptions options_;
  std::deque<RememberedFrame> frames_;
};

// Where the frame was taken from, as the map has its points by now. Empty when too few are left or agree.
std::optional<Pose> pose_in_hindsight(const RememberedFrame& frame, const Pose& camera_from_world, const MapView& map,
                                      const TrackOptions& tracking);

}  // namespace byre
