#pragma once

#include "byre/features/match.h"
#include "byre/geometry/two_view.h"
#include "byre/map/map.h"
#include "byre/slam/mapping.h"

#include <optional>
#include <vector>

namespace byre {

struct MonocularStartOptions {
  double median_depth = 1.0;  // metres, about, from the first camera to the points: one camera knows no scale
};

// A first map of one camera: two keyframes and the points that both see. The world is the body at the first keyframe.
// The unit of length is an arbitrary one, so an arm of body_from_camera that was measured in metres means nothing in
// it.
struct MonocularStart {
  Map map;
  KeyframeId first;
  KeyframeId second;             // keyframe of the frame that was tried
  double median_parallax = 0.0;  // radians, over the points of the map
  double direction_sigma = 0.0;  // radians, translation between both keyframes in the direction where it is known least
};

struct MonocularAttempt {
  std::optional<MonocularStart> start;  // empty when there is a failure
  TwoViewFailure failure = TwoViewFailure::none;
  int matches = 0;  // with the reference frame; zero when there was none yet
};

// Waits for a first map of one camera: matches frame after frame with a reference frame, until the two tell how the
// camera moved. A frame that shares too little with the reference becomes the reference of those that follow.
class MonocularInitialiser {
 public:
  // Precondition: the rig has no baseline.
  MonocularInitialiser(const Rig& rig, const MonocularStartOptions& options, const MappingOptions& mapping = {});

  // Frames in the order of time. After a start the next frame is a new reference.
  MonocularAttempt try_start(const Frame& frame);

  // The time of the frame that those which come are matched with; empty before the first.
  std::optional<Timestamp> reference_time() const {
    return reference_ ? std::optional(reference_->time) : std::nullopt;
  }

 private:
  void begin_with(const Frame& frame);
  std::vector<Match> match_with_reference(const Features& features) const;
  void follow(const std::vector<Match>& matches, const Features& features);

  // Constant after construction.
  Rig rig_;
  MonocularStartOptions options_;
  MappingOptions mapping_;

  // Owned by the calling thread.
  std::optional<Frame> reference_;
  std::vector<Eigen::Vector2f> expected_;  // pixels, one per feature of the reference: where the next frame may show it
};

}  // namespace byre
