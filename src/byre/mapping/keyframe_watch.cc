#include "byre/mapping/keyframe_watch.h"

#include "byre/mapping/anchored_trajectory.h"

#include <algorithm>

namespace byre {
namespace {

bool has_disparities(const Frame& frame) {
  return std::ranges::any_of(frame.features->keypoints(), &Keypoint::has_disparity);
}

}  // namespace

void KeyframeWatch::note_frame(const Frame& frame, const Rig& rig) {
  ++frames_since_keyframe_;
  is_short_ = false;
  frames_without_depth_ = rig.is_stereo() && !has_disparities(frame) ? frames_without_depth_ + 1 : 0;
}

void KeyframeWatch::note_track(KeyframeId reference, int inliers) {
  if (reference_ != reference) fresh_inliers_ = inliers;
  reference_ = reference;
}

void KeyframeWatch::restart() {
  frames_since_keyframe_ = 0;
  reference_.reset();
  is_to_join_ = false;
}

KeyframeEvidence KeyframeWatch::evidence(const HybridTrack& track, const MapView& map, int pending) const {
  KeyframeEvidence evidence;
  evidence.fresh_inliers = fresh_inliers_;
  evidence.frames_since_last = frames_since_keyframe_;
  evidence.without_depth = frames_without_depth_;
  evidence.pending = pending;
  evidence.offline_inliers = track.offline_inliers;
  const Pose motion = track.tracked.camera_from_world * inverse(camera_from_world(map, track.tracked.reference));
  evidence.turn = rotation_log(motion.rotation).norm();
  evidence.shift_share = motion.translation.norm() / std::max(1e-3, median_depth(track.tracked, map));
  return evidence;
}

bool KeyframeWatch::asks_for_keyframe(const HybridTrack& track, const KeyframeEvidence& evidence, const FrameCuts& cuts,
                                      const KeyframeOptions& options) {
  constexpr std::size_t kEnoughToJoin = 50;  // points
  if (is_to_join_ && track.tracked.features.size() >= kEnoughToJoin) return true;
  KeyframeEvidence judged = evidence;
  if (cuts.online_points) {
    judged.fresh_inliers = 0;
    is_short_ = static_cast<int>(track.tracked.features.size()) < options.min_tracked;
    if (is_short_) return false;
  }
  if (!cuts.right_image && needs_keyframe(track.tracked, judged, options)) return true;
  judged.without_depth = 0;
  is_short_ = needs_keyframe(track.tracked, judged, options);
  return false;
}

}  // namespace byre
