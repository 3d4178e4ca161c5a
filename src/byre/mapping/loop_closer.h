#pragma once

#include "byre/mapping/anchored_trajectory.h"
#include "byre/slam/loop_closing.h"

#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Looks for older parts of the map that the newest keyframes have come back to, and keeps what it found. Called from
// the session's thread.
class LoopCloser {
 public:
  // Places found again so far, each with what was seen of it then.
  const std::vector<LoopEdge>& loops() const { return loops_; }

  // A frame tracked in the newer part of the map.
  struct Look {
    const Frame& frame;
    Pose camera_from_world;
    const Rig& rig;
    KeyframeId newest;
    bool is_new = false;  // the newest keyframe is of this frame
  };
  // Once for each frame while no correction of the whole map is in flight. A loop that enough frames have confirmed.
  std::optional<LoopHypothesis> look(const Look& now, const Map& online);
  // Once after each look(): whether the newest keyframe is to be looked for in older parts, see find_loop.
  bool take_question() { return std::exchange(asks_for_place_, false); }
  void suspect(const LoopHypothesis& found) { hypothesis_ = found; }  // where that found one
  void add(const LoopEdge& loop) { loops_.push_back(loop); }

  // What was measured of a place is out of date.
  void forget_hypothesis() { hypothesis_.reset(); }
  void follow(const LengthChanges& changes);
  void turn(const RigTurn& turn, const Map& online);

 private:
  std::optional<LoopHypothesis> hypothesis_;  // not confirmed yet
  bool asks_for_place_ = false;
  int frames_since_loop_ = 0;  // since one was confirmed
  std::vector<LoopEdge> loops_;
};

}  // namespace byre
