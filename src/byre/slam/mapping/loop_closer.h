#pragma once

#include "byre/slam/loops/loop_closing.h"
#include "byre/slam/mapping/anchored_trajectory.h"

#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Searches for loops: older parts of the map that the newest keyframes revisit. Called from the session's thread.
class LoopCloser {
 public:
  // Loops found so far, each with its measured relative pose.
  const std::vector<LoopEdge>& loops() const { return loops_; }

  // A frame tracked in the newer part of the map.
  struct LoopFrame {
    const Frame& frame;
    Pose camera_from_world;
    const Rig& rig;
    KeyframeId newest;
    bool is_new = false;  // the newest keyframe is this frame
  };
  // Called per frame while no correction of the whole map is in flight. Returns a loop once enough frames confirm it.
  std::optional<LoopHypothesis> check(const LoopFrame& now, const MapGraph& online);
  // Called once after each check(): whether to search older parts of the map for the newest keyframe, see find_loop.
  bool take_search_request() { return std::exchange(is_search_requested_, false); }
  void set_hypothesis(const LoopHypothesis& found) { hypothesis_ = found; }  // result of that search
  void add(const LoopEdge& loop) { loops_.push_back(loop); }

  // Drops the hypothesis, whose measured pose is out of date.
  void forget_hypothesis() { hypothesis_.reset(); }
  void apply_length_changes(const LengthChanges& changes);
  void rotate_rig(const RigRotation& turn, const MapGraph& online);

 private:
  std::optional<LoopHypothesis> hypothesis_;  // not yet confirmed
  bool is_search_requested_ = false;
  int frames_since_loop_ = 0;  // since the last confirmed loop
  std::vector<LoopEdge> loops_;
};

}  // namespace byre
