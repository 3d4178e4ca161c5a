#pragma once

#include "byre/frame_cuts.h"
#include "byre/slam/frame/hybrid_tracking.h"
#include "byre/slam/tracking/keyframes.h"

#include <optional>

namespace byre {

// Evidence for a new keyframe, gathered from frame to frame. Called from the session's thread.
class KeyframePolicy {
 public:
  // Called per frame, with or without a pose.
  void note_frame(const Frame& frame, const Rig& rig);
  // The frame was tracked on `inliers` points with this reference keyframe.
  void note_track(KeyframeId reference, int inliers);
  // The frame was relocalised, and odometry measured the motion since tracking was lost: a keyframe is needed to link
  // the earlier map to this place by that motion.
  void require_keyframe() { is_required_ = true; }
  // A keyframe was made.
  void restart(KeyframeId keyframe);

  // For the frame noted last. pending: number of keyframes not yet processed by mapping.
  KeyframeEvidence evidence(const HybridTrack& track, const MapView& map, int pending) const;

  // Whether the frame noted last becomes a keyframe. cuts: omitted parts of its processing. If only few online points
  // were searched, their number is no evidence. Without an available right image no keyframe is made.
  bool should_add_keyframe(const HybridTrack& track, const KeyframeEvidence& evidence, const FrameCuts& cuts,
                           const KeyframeOptions& options);
  // Whether that frame had too few points, or no depths, for a keyframe.
  bool is_short() const { return is_short_; }

 private:
  std::optional<KeyframeId> reference_of(const HybridTrack& track, const MapView& map) const;

  int frames_since_keyframe_ = 0;
  int frames_without_depth_ = 0;             // consecutive frames without disparities, stereo rigs only
  std::optional<KeyframeId> last_keyframe_;  // online
  std::optional<KeyframeId> reference_;      // reference of the last tracked frame
  int fresh_inliers_ = 0;                    // in the first frame tracked with that reference
  bool is_short_ = false;
  bool is_required_ = false;
};

}  // namespace byre
