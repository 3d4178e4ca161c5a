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

// Motion of the body from wheels and gyroscope. Estimates their mounting, scale, bias and delay by comparison with
// visual poses, and keeps updating them. Yields no motion before these are estimated or presumed. Ignores wheels while
// they disagree with the images, such as during slip. Not thread-safe.
class MotionPrior {
 public:
  explicit MotionPrior(const MotionLimits& limits = {}) : check_(limits) {}

  // Declares the map metric independent of wheels. A contradicting wheel scale is reported.
  void expect_metres() { knows_metres_ = true; }
  // Sets a prior from an earlier drive, with which wheels yield motion from the first frame on. Dropped if motions
  // contradict it. Call it before any other input.
  void begin_with(const KnownMounting& known);
  // Sets the approximate up and forward axes of the body. The first motions then yield a presumed mounting, used until
  // it can be estimated; otherwise there is no motion before the estimate. Call it before any other input.
  // ahead_in_body: the direction in which the body drives.
  void presume_upright(const Eigen::Vector3d& up_in_body, const Eigen::Vector3d& ahead_in_body) {
    up_in_body_ = up_in_body;
    before_sight_ = presume_looking_ahead(up_in_body, ahead_in_body);
  }
  // Sets the calibrated rotation of the gyroscope. Until it is estimated, it serves only to find the up axis from
  // accelerations at standstill.
  void presume_gyroscope(const Eigen::Quaterniond& body_from_gyroscope);
  // Mode for making a map: keeps samples for up to half an hour instead of two minutes, and recomputes the poses of
  // untracked frames at the end from the final mounting. Before the first tracked frame, wheels yield motion with the
  // body presumed to look ahead: the distance is measured, the direction hardly.
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

  // Adds a frame with its smooth visual pose, in lengths of the map; empty if it was not tracked.
  void note(Timestamp time, const std::optional<Pose>& odometry_from_body);

  // Sets the map pose of the last noted frame. Call it only for trusted poses.
  void note_place(const Pose& map_from_body) { standing_.note_place(map_from_body.rotation); }

  // Tilt of the body at the next frame from accelerations; empty unless wheels measure standstill until then.
  std::optional<BodyTilt> tilt(Timestamp time) const;

  // The body's motion between frames, in lengths of the map. A gyroscope alone measures only the rotation; the
  // translation then continues the last visual velocity, for 1 s at most. Empty if unknown.
  std::optional<BodyMotion> between(Timestamp earlier, Timestamp later) const;

  // Motion between frames that may be long past, with the present estimates: translation from wheels, rotation from the
  // gyroscope if available.
  std::optional<BodyMotion> way_between(Timestamp earlier, Timestamp later) const;

  // Upper bound of the body's displacement, in lengths of the map, by the distance that the wheels measured. Empty if
  // unknown. is_metric: the map's lengths are metres, so that the bound needs no mounting.
  std::optional<double> reach(Timestamp earlier, Timestamp later, bool is_metric) const;

  // After the last frame: estimates the mounting of wheels anew from the final map poses of the tracked frames. Poses
  // of untracked frames are ignored, because wheels themselves determined them.
  void look_again(const Trajectory& seen);

  // After look_again: lengths of the map are multiplied by this factor from here on.
  void stretch(double factor);

  // The final poses of tracked frames, and those of untracked frames which wheels connect to them.
  Trajectory completed(Trajectory seen) const;

  const std::optional<WheelMounting>& wheels() const { return mounting_; }
  const Standing& standing() const { return standing_; }
  const std::optional<GyroscopeMounting>& gyroscope() const { return gyroscope_; }
  // Delay of wheel stamps against the camera's, seconds.
  double time_offset() const { return time_offset_.value_or(0.0); }
  bool are_wheels_slipping() const { return is_slipping_; }
  int slips() const { return slips_; }  // number of periods of slip
  // The mounting of wheels differs from that of the earlier drive.
  bool is_mounted_otherwise() const { return is_mounted_otherwise_; }
  // Mounting for the next drive: the estimates, or the earlier ones if not contradicted.
  KnownMounting to_keep() const;

 private:
  static constexpr Timestamp kUsuallyKept = std::chrono::minutes(2);
  static constexpr Timestamp kMostKept = std::chrono::minutes(30);  // limit also while there is no mounting

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
  const WheelMounting* used_mounting() const;  // nullptr if nothing is estimated or presumed
  void watch_for_slip(const SeenMotion& motion);
  void check_known(double disagreement, const SeenMotion& motion);
  void drop_known_wheels();
  void ask_gyroscope();
  std::vector<MotionPair> pairs() const;
  // In the clock of the wheels.
  Timestamp wheel_time(Timestamp time) const { return time + from_seconds(time_offset()); }
  std::optional<Pose> base_between(Timestamp earlier, Timestamp later) const;
  struct ToldBase {
    Pose motion;                // earlier_from_later, metres
    bool is_way_known = true;   // wheels agree with the gyroscope, if any, and show no jerk
    bool is_turn_known = true;  // measured by the gyroscope, or by wheels without a jerk
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
  std::optional<StampedPose> begin_;  // first frame of the motion in progress
  std::optional<StampedPose> last_;   // last frame, if tracked
  std::optional<Vector6> velocity_;   // last visual velocity of the body, per second
  int unlooked_ = 0;                  // tracked motions since the last estimation of mountings
  int looks_ = 0;                     // number of estimations that yielded a mounting of wheels
  std::optional<WheelMounting> mounting_;
  std::optional<Eigen::Vector3d> up_in_body_;
  std::optional<WheelMounting> presumed_;      // only without mounting_
  std::optional<WheelMounting> before_sight_;  // until the first tracked frame
  bool tells_before_sight_ = false;
  std::optional<Eigen::Vector3d> measured_up_;  // measured by accelerations
  std::optional<GyroscopeMounting> presumed_gyroscope_;
  std::optional<GyroscopeMounting> gyroscope_;
  std::optional<double> time_offset_;
  bool is_slipping_ = false;
  int agreeing_ = 0;  // number of motions since slip in which wheels agree with images
  int slips_ = 0;
  KnownMounting known_;          // from an earlier drive, until contradicted
  int contradicting_ = 0;        // number of motions that contradict the earlier mounting of wheels
  int bearing_out_ = 0;          // number of motions that agree with it
  int contradicting_looks_ = 0;  // consecutive estimates that contradict the earlier mounting
  bool is_mounted_otherwise_ = false;
};

}  // namespace byre
