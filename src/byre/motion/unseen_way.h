#pragma once

#include "byre/trajectory.h"

#include <deque>
#include <functional>
#include <optional>

namespace byre {

// The way through frames in which nothing was seen, as wheels told it. Often it is known only later how they are
// mounted, as where one camera could not begin a map yet. Then these frames get their poses afterwards.
class UnseenWay {
 public:
  // The base's motion between two frames, earlier_from_later in metres; empty where it was not told.
  using Tell = std::function<std::optional<Pose>(Timestamp earlier, Timestamp later)>;
  // The body's motion, in the map's lengths, by that of the base.
  using BodyMotionOf = std::function<Pose(const Pose& base)>;

  // A frame, in order of time.
  void note(Timestamp time, bool is_seen);

  std::optional<Timestamp> last() const { return last_; }  // last frame
  // Whether each frame between the two was seen, and they were.
  bool is_seen(Timestamp earlier, Timestamp later) const;
  // Steps that were not told yet begin at this time; empty: there are none.
  std::optional<Timestamp> first_untold() const;
  // Takes down the steps that were not told yet.
  void take_down(const Tell& tell);

  // Poses that the trajectory has of frames in which nothing was seen: told at the time, perhaps by less than is known
  // now.
  enum class OldPoses { kept, made_anew };

  // The trajectory, with poses for the unseen frames that wheels lead to from one of its poses. Between two of them,
  // each takes its share, by time, of what the way was told wrongly. world_from_body.
  Trajectory completed(Trajectory trajectory, const BodyMotionOf& body_motion_of, OldPoses old = OldPoses::kept) const;

 private:
  struct Frames {
    Timestamp earlier{};
    Timestamp later{};
    bool is_later_seen = false;
  };
  struct Step {
    Frames frames;
    std::optional<Pose> base;
  };

  std::optional<Timestamp> last_;
  bool was_seen_ = false;
  std::deque<Frames> untold_;
  std::deque<Step> steps_;
};

}  // namespace byre
