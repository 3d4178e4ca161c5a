#pragma once

#include "byre/frame_cuts.h"

#include <functional>
#include <optional>

namespace byre {

// How long a stage takes, from how long it took: the mean and how far single times lie off it, both forgetting, as
// round trips are timed in TCP (Jacobson, Congestion Avoidance and Control, 1988).
class ExpectedTime {
 public:
  void note(double seconds);
  // The stage was left out: little by little it is thought to be shorter, so that it is tried again.
  void fade();
  // Seldom exceeded; empty before the stage was ever done.
  std::optional<double> seconds() const;
  double mean() const { return mean_.value_or(0.0); }

 private:
  std::optional<double> mean_;
  double deviation_ = 0.0;  // mean absolute one
};

// Sees to it that a frame takes no longer than it may, by leaving work out where times lately say that it would. Online
// points come first, then the right image; offline points are never left out. A frame on time costs nothing but looks
// at the clock. Called from the session's thread.
class FrameBudget {
 public:
  using Clock = std::function<double()>;  // seconds, from any moment on

  // deadline: wall time that a frame may take, seconds; 0: as long as it needs.
  explicit FrameBudget(double deadline, Clock clock = wall_clock());

  void begin();  // a frame has come
  // Asked before its images are looked at.
  bool has_time_for_right_image();
  // Tracking begins: what is left out of the frame, its right image included.
  FrameCuts begin_tracking();
  void note_tracked();  // the frame was tracked, and not looked for from nothing
  // Nothing is left out of the next frame: a keyframe waits for depths, or too few points were seen in this one.
  void keep_next_whole() { is_next_whole_ = true; }
  void end();  // there is a report

  const FrameCuts& cuts() const { return cuts_; }  // what was left out of this frame
  bool is_late() const { return is_late_; }        // it took longer than it may

 private:
  // A stage whole, and with what may be left out of it.
  struct Stage {
    ExpectedTime whole;
    ExpectedTime cut;

    void note(double seconds, bool is_cut);
    double expected() const { return whole.seconds().value_or(0.0); }
    double expected_when_cut() const;
  };

  static Clock wall_clock();
  bool is_set() const { return deadline_ > 0.0; }
  double elapsed() const { return clock_() - begun_; }

  double deadline_ = 0.0;  // constant after construction
  Clock clock_;

  Stage images_;  // until tracking begins
  Stage tracking_;
  ExpectedTime rest_;  // from tracking on: by its mean, as nothing left out spares a keyframe's frame its longer time
  double begun_ = 0.0;
  double tracking_begun_ = 0.0;           // seconds after begin(), as the next
  std::optional<double> tracking_ended_;  // empty where the frame was not tracked
  FrameCuts cuts_;
  bool is_late_ = false;
  bool is_whole_ = false;  // nothing is left out of this frame
  bool is_next_whole_ = false;
};

}  // namespace byre
