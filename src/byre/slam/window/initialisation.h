#pragma once

#include "byre/features/match.h"
#include "byre/geometry/two_view.h"
#include "byre/map/map.h"
#include "byre/slam/window/mapping.h"

#include <optional>
#include <vector>

namespace byre {

struct MonocularStartOptions {
  // Metres, assumed distance from the first camera to the points; the scale is not observable.
  double median_depth = 1.0;
};

// First map of one camera: two keyframes and the points that both see. The world is the body at the first keyframe. The
// unit of length is arbitrary, so a metric lever arm of body_from_camera does not apply.
struct MonocularStart {
  Map map;
  KeyframeId first;
  KeyframeId second;             // keyframe of the tried frame
  double median_parallax = 0.0;  // radians, over the points of the map
  // Radians, of the translation between both keyframes along its least certain direction.
  double direction_sigma = 0.0;
};

struct MonocularAttempt {
  std::optional<MonocularStart> start;  // empty after a failure
  TwoViewFailure failure = TwoViewFailure::none;
  int matches = 0;  // with the reference frame; 0 without one
};

// Initialises a monocular map: matches frames with a reference frame until the two determine the camera's motion. A
// frame with too few matches becomes the new reference.
class MonocularInitialiser {
 public:
  // Precondition: the rig has no baseline.
  MonocularInitialiser(const Rig& rig, const MonocularStartOptions& options, const MappingOptions& mapping = {});

  // Frames in order of time. After a start the next frame becomes the reference.
  MonocularAttempt try_start(const Frame& frame);

  // Time of the reference frame; empty before the first.
  std::optional<Timestamp> reference_time() const {
    return reference_ ? std::optional(reference_->time) : std::nullopt;
  }

 private:
  void begin_with(const Frame& frame);
  std::vector<Match> match_with_reference(const Features& features) const;
  void update_expected(const std::vector<Match>& matches, const Features& features);

  // Constant after construction.
  Rig rig_;
  MonocularStartOptions options_;
  MappingOptions mapping_;

  // Owned by the calling thread.
  std::optional<Frame> reference_;
  // Pixels, one per feature of the reference: its expected position in the next frame.
  std::vector<Eigen::Vector2f> expected_;
};

}  // namespace byre
