#include "byre/slam/mapping/keyframe_policy.h"

#include "byre/slam/mapping/anchored_trajectory.h"

#include <algorithm>
#include <limits>

namespace byre {
namespace {

bool has_disparities(const Frame& frame) {
  return std::ranges::any_of(frame.features->keypoints(), &Keypoint::has_disparity);
}

}  // namespace

void KeyframePolicy::note_frame(const Frame& frame, const Rig& rig) {
  ++frames_since_keyframe_;
  is_short_ = false;
  frames_without_depth_ = rig.is_stereo() && !has_disparities(frame) ? frames_without_depth_ + 1 : 0;
}

void KeyframePolicy::note_track(KeyframeId reference, int inliers) {
  if (reference_ != reference) fresh_inliers_ = inliers;
  reference_ = reference;
}

void KeyframePolicy::restart(KeyframeId keyframe) {
  last_keyframe_ = keyframe;
  frames_since_keyframe_ = 0;
  reference_.reset();
  is_required_ = false;
}

// Offline references change along the way, so motion from them needs no keyframe. Online points take over where the
// offline ones end: while the frame shows few of both, motion counts from the last online keyframe. Empty without one.
std::optional<KeyframeId> KeyframePolicy::reference_of(const HybridTrack& track, const MapView& map) const {
  constexpr int kManyOnline = 100;  // points
  const KeyframeId& reference = track.tracked.reference;
  if (track.offline_inliers >= kManyOffline) return track.offline_reference;
  if (reference.origin == Origin::online || track.online_inliers() >= kManyOnline) return reference;
  const bool is_known = last_keyframe_ && map.find_keyframe(*last_keyframe_) != nullptr;
  return is_known ? last_keyframe_ : std::nullopt;
}

KeyframeEvidence KeyframePolicy::evidence(const HybridTrack& track, const MapView& map, int pending) const {
  KeyframeEvidence evidence;
  evidence.fresh_inliers = fresh_inliers_;
  evidence.frames_since_last = frames_since_keyframe_;
  evidence.without_depth = frames_without_depth_;
  evidence.pending = pending;
  evidence.offline_inliers = track.offline_inliers;
  const std::optional<KeyframeId> reference = reference_of(track, map);
  evidence.shift_share = std::numeric_limits<double>::infinity();
  if (!reference) return evidence;
  const Pose motion = track.tracked.camera_from_world * inverse(camera_from_world(map, *reference));
  evidence.turn = rotation_log(motion.rotation).norm();
  evidence.shift_share = motion.translation.norm() / std::max(1e-3, median_depth(track.tracked, map));
  return evidence;
}

bool KeyframePolicy::should_add_keyframe(const HybridTrack& track, const KeyframeEvidence& evidence,
                                         const FrameCuts& cuts, const KeyframeOptions& options) {
  constexpr std::size_t kEnoughToJoin = 50;  // points
  if (is_required_ && track.tracked.features.size() >= kEnoughToJoin) return true;
  KeyframeEvidence reduced = evidence;
  if (cuts.online_points) {
    reduced.fresh_inliers = 0;
    is_short_ = static_cast<int>(track.tracked.features.size()) < options.min_tracked;
    if (is_short_) return false;
  }
  if (!cuts.right_image && needs_keyframe(track.tracked, reduced, options)) return true;
  reduced.without_depth = 0;
  is_short_ = needs_keyframe(track.tracked, reduced, options);
  return false;
}

}  // namespace byre
