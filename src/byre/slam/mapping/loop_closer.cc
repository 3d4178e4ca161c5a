#include "byre/slam/mapping/loop_closer.h"

namespace byre {

std::optional<LoopHypothesis> LoopCloser::check(const LoopFrame& now, const MapGraph& online) {
  is_search_requested_ = false;
  if (++frames_since_loop_ < kMinFramesBetweenLoops) return std::nullopt;
  if (!hypothesis_) {
    is_search_requested_ = now.is_new;
    return std::nullopt;
  }
  hypothesis_ = check_loop(*hypothesis_, now.frame, now.camera_from_world, now.rig, online);
  if (is_refuted(*hypothesis_)) hypothesis_.reset();
  if (!hypothesis_ || !is_confirmed(*hypothesis_)) return std::nullopt;
  frames_since_loop_ = 0;
  return std::exchange(hypothesis_, std::nullopt);
}

void LoopCloser::apply_length_changes(const LengthChanges& changes) {
  for (LoopEdge& loop : loops_) loop = in_new_lengths(loop, changes);
}

void LoopCloser::rotate_rig(const RigRotation& turn, const MapGraph& online) {
  for (LoopEdge& loop : loops_) {
    loop.keyframe_from_place = rotation_of(turn, loop.keyframe, online) * loop.keyframe_from_place *
                               inverse(rotation_of(turn, loop.place, online));
  }
  forget_hypothesis();
}

}  // namespace byre
