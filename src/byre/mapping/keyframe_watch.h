#pragma once

#include "byre/frame_cuts.h"
#include "byre/slam/hybrid_tracking.h"
#include "byre/slam/keyframes.h"

#include <optional>

namespace byre {

// What speaks for a new keyframe, gathered from frame to frame. Called from the session's thread.
class KeyframeWatch {
 public:
  // A frame came, whether it has a pose or not.
  void note_frame(const Frame& frame, const Rig& rig);
  // The frame was tracked on so many points, with this reference keyframe.
  void note_track(KeyframeId reference, int inliers);
  // The frame was found again, and it was told how the body has moved since it was lost: a keyframe is to join what was
  // mapped before to that place by the way that was told.
  void note_found() { is_to_join_ = true; }
  // A keyframe was made.
  void restart();

  // For the frame noted last; pending: keyframes that mapping has not worked on.
  KeyframeEvidence evidence(const HybridTrack& track, const MapView& map, int pending) const;

  // Whether the frame noted last is to become a keyframe. cuts: what was left out of it. Where few online points were
  // looked for their number says nothing of the view, and no keyframe is made without a right image that was there.
  bool asks_for_keyframe(const HybridTrack& track, const KeyframeEvidence& evidence, const FrameCuts& cuts,
                         const KeyframeOptions& options);
  // Whether that one had too few points, or no depths, to become one.
  bool is_short() const { return is_short_; }

 private:
  int frames_since_keyframe_ = 0;
  int frames_without_depth_ = 0;         // since one had disparities, with a rig that gives them
  std::optional<KeyframeId> reference_;  // reference of the last frame tracked
  int fresh_inliers_ = 0;                // in the first frame tracked with that reference
  bool is_short_ = false;
  bool is_to_join_ = false;
};

}  // namespace byre
