#pragma once

#include "byre/body_motion.h"
#include "byre/motion/gyroscope_mounting.h"
#include "byre/motion/known_mounting.h"
#include "byre/motion/motion_check.h"
#include "byre/motion/rate_track.h"
#include "byre/motion/seen_motion.h"
#include "byre/motion/standing.h"
#include "byre/motion/unseen_way.h"
#include "byre/motion/wheel_mounting.h"
#include "byre/motion/wheel_track.h"
#include "byre/trajectory.h"

#include <chrono>
#include <deque>
#include <optional>
#include <vector>

namespace byre {

// What wheels and a gyroscope tell of the body's motion. How they are mounted, their scale, bias and delay are found by
// comparing them with what is seen, and followed while that goes on. Nothing is told before they are known, or can be
// presumed. Where wheels do not move as is seen they are left out, until they do again. Call it from one thread.
class MotionPrior {
 public:
  explicit MotionPrior(const MotionLimits& limits = {}) : check_(limits) {}

  // Lengths of the map are metres without wheels. A wheel scale that contradicts them is reported.
  void expect_metres() { knows_metres_ = true; }
  // How they were mounted on a drive before, as a guess: wheels tell from the first frame on. Where motions contradict
  // it, it is dropped. Call it before anything is told.
  void begin_with(const KnownMounting& known);
  // Which axis of the body points up, about: by that the mounting is guessed from the first motions, until they tell
  // it. Without it nothing is told before. Call it before anything is told.
  // ahead_in_body: about, the axis that looks to where the body drives.
  void presume_upright(const Eigen::Vector3d& up_in_body, const Eigen::Vector3d& ahead_in_body) {
    up_in_body_ = up_in_body;
    before_sight_ = presume_looking_ahead(up_in_body, ahead_in_body);
  }
  // How the gyroscope is turned, as somebody says: accelerations of a body that stands still tell by it which axis
  // points up, until turns have told how it is turned. Nothing else hangs on it.
  void presume_gyroscope(const Eigen::Quaterniond& body_from_gyroscope);
  // A map is made: ways of up to half an hour ago will be asked for, not two minutes, and in the end poses of frames
  // that were not seen are made anew by what is known then. Before anything is seen wheels tell, too, as though the
  // body looked to where it drives: how far it went, but hardly which way.
  void serve_mapping() {
    samples_kept_ = kMostKept;
    old_poses_ = UnseenWay::OldPoses::made_anew;
    tells_before_sight_ = true;
  }

  // Samples are checked (MotionCheck); faulty ones are dropped.
  void add(const StampedPose& wheels);
  void add(const BaseVelocity& wheels);
  void add(const AngularRate& rate);
  void add(const Acceleration& acceleration);
  // A motion of the body given by the caller; empty if it is faulty. seconds: its duration.
  std::optional<BodyMotion> checked(const BodyMotion& motion, Timestamp time, double seconds) {
    return check_.check(motion, time, seconds);
  }
  const std::vector<MotionWarning>& warnings() const { return check_.warnings(); }  // all so far
  void warn(const MotionWarning& warning) { check_.warn(warning); }
  bool is_empty() const { return wheels_.empty() && rates_.empty(); }

  // A frame's smooth pose, in the map's lengths, as it was seen; empty where nothing was.
  void note(Timestamp time, const std::optional<Pose>& odometry_from_body);

  // The pose in the map of the frame that was noted last, where it is trusted.
  void note_place(const Pose& map_from_body) { standing_.note_place(map_from_body.rotation); }

  // How the body is tilted at the next frame, by accelerations; empty unless wheels say that it stands still until
  // then.
  std::optional<BodyTilt> tilt(Timestamp time) const;

  // The body's motion between frames, in the map's lengths. A gyroscope alone tells a turn; the way is then taken to go
  // on as it was seen, for a second at most. Empty where it is not known.
  std::optional<BodyMotion> between(Timestamp earlier, Timestamp later) const;

  // The same of moments that may be long ago, by what is known now: by wheels alone, with the turn by the gyroscope.
  std::optional<BodyMotion> way_between(Timestamp earlier, Timestamp later) const;

  // How far the body can be, in the map's lengths, from where it was: no farther than wheels turned. Empty where that
  // is not known; is_metric: the map's lengths are metres, so that wheels tell it before it is known how they are
  // mounted.
  std::optional<double> reach(Timestamp earlier, Timestamp later, bool is_metric) const;

  // After the last frame: the mounting that was known by what was seen as the map has it in the end. Poses of frames
  // that were not seen tell nothing: they are those that wheels told.
  void look_again(const Trajectory& seen);

  // After that: the lengths of the map, and of what is told from here on, are so many times as long.
  void stretch(double factor);

  // The final poses of frames that were seen, with those of frames that wheels lead to from them.
  Trajectory completed(Trajectory seen) const;

  const std::optional<WheelMounting>& wheels() const { return mounting_; }
  const Standing& standing() const { return standing_; }
  const std::optional<GyroscopeMounting>& gyroscope() const { return gyroscope_; }
  double time_offset() const { return time_offset_.value_or(0.0); }  // seconds that wheels stamp later than the camera
  bool are_wheels_slipping() const { return is_slipping_; }
  int slips() const { return slips_; }  // times that they began to
  // Wheels are not mounted as they were before.
  bool is_mounted_otherwise() const { return is_mounted_otherwise_; }
  // What the next drive may begin with: what was found out, or known before and not contradicted.
  KnownMounting to_keep() const;

 private:
  static constexpr Timestamp kUsuallyKept = std::chrono::minutes(2);
  static constexpr Timestamp kMostKept = std::chrono::minutes(30);  // while the mounting is not known, too

  void compare_turns(Timestamp time, const std::optional<SeenMotion>& seen);
  void drop_wheels();
  void drop_gyroscope();
  void forget_old_samples();
  void watch_standing(Timestamp time, const std::optional<Pose>& seen);
  std::optional<bool> do_wheels_stand(Timestamp time) const;
  std::optional<SteadyTrack::Steady> standing_by_wheels(Timestamp time) const;
  void look_for_mountings();
  void look_for_wheel_mounting();
  void presume_mounting();
  const WheelMounting* used_mounting() const;  // nullptr where nothing is known or presumed
  void watch_for_slip(const SeenMotion& motion);
  void check_known(double disagreement, const SeenMotion& motion);
  void drop_known_wheels();
  void ask_gyroscope();
  std::vector<MotionPair> pairs() const;
  Timestamp wheel_time(Timestamp time) const { return time + from_seconds(time_offset()); }  // time by stamps of wheels
  std::optional<Pose> base_between(Timestamp earlier, Timestamp later) const;
  struct ToldBase {
    Pose motion;                // earlier_from_later, metres
    bool is_way_known = true;   // wheels agree with the gyroscope, if there is one, and have no jerk
    bool is_turn_known = true;  // by the gyroscope, or by wheels without a jerk
  };
  std::optional<ToldBase> told_base(Timestamp earlier, Timestamp later,
                                    const std::optional<Eigen::Quaterniond>& turn) const;
  UnseenWay::Tell tell_base() const;
  std::optional<BodyMotion> by_wheels(Timestamp earlier, Timestamp later,
                                      const std::optional<Eigen::Quaterniond>& turn) const;
  bool contradicts_wheels(Timestamp earlier, Timestamp later, const Eigen::Quaterniond& turn) const;
  std::optional<BodyMotion> across_jump(Timestamp earlier, Timestamp later,
                                        const std::optional<Eigen::Quaterniond>& turn) const;
  bool is_jerk(Timestamp earlier, Timestamp later, const Pose& base) const;
  std::optional<BodyMotion> by_sight(Timestamp earlier, Timestamp later) const;
  std::optional<Eigen::Quaterniond> turn_by_gyroscope(Timestamp earlier, Timestamp later) const;

  MotionCheck check_;
  bool knows_metres_ = false;
  std::optional<Timestamp> turns_compared_;  // end of the last comparison of wheels and gyroscope without images
  WheelTrack wheels_;
  RateTrack rates_;
  Standing standing_;
  Timestamp samples_kept_ = kUsuallyKept;
  UnseenWay unseen_;
  UnseenWay::OldPoses old_poses_ = UnseenWay::OldPoses::kept;
  std::deque<SeenMotion> seen_;       // motions of the last minutes, half a second each
  std::optional<StampedPose> begin_;  // begin of the motion that is being seen
  std::optional<StampedPose> last_;   // the last frame, where it was seen
  std::optional<Vector6> velocity_;   // velocity of the body, per second, when it was seen last
  int unlooked_ = 0;                  // motions seen since mountings were looked for
  int looks_ = 0;                     // looks by which the mounting of wheels was known
  std::optional<WheelMounting> mounting_;
  std::optional<Eigen::Vector3d> up_in_body_;
  std::optional<WheelMounting> presumed_;      // while mounting_ is not known
  std::optional<WheelMounting> before_sight_;  // until anything is seen
  bool tells_before_sight_ = false;
  std::optional<Eigen::Vector3d> measured_up_;  // by accelerations
  std::optional<GyroscopeMounting> presumed_gyroscope_;
  std::optional<GyroscopeMounting> gyroscope_;
  std::optional<double> time_offset_;
  bool is_slipping_ = false;
  int agreeing_ = 0;  // motions that wheels told as they were seen, since they slipped
  int slips_ = 0;
  KnownMounting known_;          // from a drive before, while it is not contradicted
  int contradicting_ = 0;        // motions that what is known of wheels is not true of
  int bearing_out_ = 0;          // motions that it is true of
  int contradicting_looks_ = 0;  // looks in a row by which wheels are mounted otherwise
  bool is_mounted_otherwise_ = false;
};

}  // namespace byre
