#pragma once

#include "byre/odometry/visual_motion.h"
#include "byre/trajectory.h"

#include <deque>
#include <functional>
#include <optional>
#include <vector>

namespace byre {

// Path through untracked frames by wheel odometry. Computes their poses afterwards, once the calibration of wheels is
// estimated; this covers frames before a monocular map begins.
class GapTrajectory {
 public:
  // The base's motion between two frames, earlier_from_later in metres; empty if not measured.
  using BaseOdometry = std::function<std::optional<Pose>(Timestamp earlier, Timestamp later)>;
  // Converts the base's motion to the body's, in lengths of the map.
  using BodyMotionOf = std::function<Pose(const Pose& base)>;

  // Adds a frame, in order of time.
  void note(Timestamp time, bool is_seen);

  std::optional<Timestamp> last() const { return last_; }  // last frame
  // Whether both frames and all frames between them were tracked.
  bool is_seen(Timestamp earlier, Timestamp later) const;
  // Motions of at least this length in time between poses of tracked frames.
  std::deque<VisualMotion> motions_between_gaps(const Trajectory& seen, Timestamp length) const;
  // Start of the first step without a stored motion; empty if there is none.
  std::optional<Timestamp> first_pending() const;
  // Counts frames as tracked that were located later, by ascending times.
  void note_located(const std::vector<Timestamp>& times);
  // Stores the motions of these steps.
  void integrate(const BaseOdometry& odometry);

  // Treatment of poses that the trajectory already has for untracked frames: keep them, or recompute them with the
  // present calibration.
  enum class OldPoses { kept, recomputed };

  // The trajectory with added poses for untracked frames that wheels connect to one of its poses. Between two such
  // poses the drift of wheels is distributed in proportion to time. world_from_body.
  Trajectory fill_gaps(Trajectory trajectory, const BodyMotionOf& body_motion_of, OldPoses old = OldPoses::kept) const;

 private:
  struct Frames {
    Timestamp earlier{};
    Timestamp later{};
    bool is_earlier_seen = false;
    bool is_later_seen = false;
  };
  struct Step {
    Frames frames;
    std::optional<Pose> base;
  };

  std::optional<Timestamp> last_;
  bool was_seen_ = false;
  std::deque<Frames> pending_;
  std::deque<Step> steps_;
};

}  // namespace byre
