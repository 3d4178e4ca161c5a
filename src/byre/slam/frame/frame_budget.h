#pragma once

#include "byre/frame_cuts.h"

#include <functional>
#include <optional>

namespace byre {

// Expected time of a stage, from the mean and mean deviation of past times, both with exponential decay, as round trips
// are timed in TCP (Jacobson, Congestion Avoidance and Control, 1988).
class ExpectedTime {
 public:
  void note(double seconds);
  // The stage was skipped: the expectation decays, so that it is tried again.
  void decay();
  // Seldom exceeded; empty before the first measurement.
  std::optional<double> seconds() const;
  double mean() const { return mean_.value_or(0.0); }

 private:
  std::optional<double> mean_;
  double deviation_ = 0.0;  // mean absolute deviation
};

// Keeps frames within a deadline: skips work if recent times predict an overrun, first online points, then the right
// image, never offline points. A frame on time costs only readings of the clock. Called from the session's thread.
class FrameBudget {
 public:
  using Clock = std::function<double()>;  // seconds from an arbitrary origin

  // deadline: wall time of a frame, seconds; 0: none.
  explicit FrameBudget(double deadline, Clock clock = wall_clock());

  void begin();  // a frame arrives
  // Before the images are processed.
  bool has_time_for_right_image();
  // Begins tracking. Returns all skipped work of the frame, the right image included.
  FrameCuts begin_tracking();
  void note_tracked();  // the frame was tracked, without a place search
  // Skips nothing in the next frame: a keyframe waits for depths, or this frame had too few points.
  void keep_next_whole() { is_next_whole_ = true; }
  void end();  // the report is complete

  const FrameCuts& cuts() const { return cuts_; }  // skipped work of this frame
  bool is_late() const { return is_late_; }        // the frame exceeded the deadline

 private:
  // Times of a stage, whole and with skipped work.
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
  // Time after tracking; expected by its mean, since skipped work does not shorten the longer frames of keyframes.
  ExpectedTime rest_;
  double begun_ = 0.0;
  double tracking_begun_ = 0.0;           // seconds after begin()
  std::optional<double> tracking_ended_;  // seconds after begin(); empty: not tracked
  FrameCuts cuts_;
  bool is_late_ = false;
  bool is_whole_ = false;  // nothing is skipped in this frame
  bool is_next_whole_ = false;
};

}  // namespace byre
