#pragma once

#include "byre/body_motion.h"
#include "byre/odometry/calibrated_odometry.h"
#include "byre/odometry/gap_trajectory.h"
#include "byre/odometry/motion_check.h"
#include "byre/odometry/odometry_calibration.h"
#include "byre/odometry/visual_motion.h"
#include "byre/trajectory.h"

#include <chrono>
#include <deque>
#include <optional>
#include <vector>

namespace byre {

// Motion of the body from wheels and gyroscope. Estimates their calibration, scale, bias and delay by comparison with
// visual poses, and keeps updating them. Yields no motion before these are estimated or assumed. Ignores wheels while
// they disagree with the images, such as during slip. Not thread-safe.
class OdometryCalibrator {
 public:
  explicit OdometryCalibrator(const MotionLimits& limits = {}) : check_(limits) {}

  // Declares the map metric independent of wheels. A contradicting wheel scale is reported.
  void set_metric() { is_metric_ = true; }
  // Sets a prior from an earlier drive, with which wheels yield motion from the first frame on. Dropped if motions
  // contradict it. Call it before any other input.
  void begin_with(const OdometryCalibration& known);
  // Sets extrinsics measured by hand as the prior, instead of those of an earlier drive that differ from them.
  // time_offset: delay of the wheels' stamps, seconds; empty: unknown. Call it after begin_with().
  void begin_with_extrinsics(const WheelCalibration& measured, std::optional<double> time_offset);
  // Images contradict the given extrinsics, which are reported and dropped. time: of the frame.
  void reject_extrinsics(Timestamp time) { discard_prior_wheels(time); }
  bool uses_given_extrinsics() const { return prior_.is_measured; }
  // The map began in metres of the wheels: by this motion, of the body in images. Without a prior, one from here on is
  // a body that looks ahead, in metres.
  void begin_metric(const VisualMotion& first);
  // The map began with a unit other than metres. The prior is in use again once the first motions determine the unit.
  void forget_scale();
  // Sets the approximate up and forward axes of the body. The first motions then yield an assumed calibration, used
  // until it can be estimated; otherwise there is no motion before the estimate. Call it before any other input.
  // ahead_in_body: the direction in which the body drives.
  void assume_upright(const Eigen::Vector3d& up_in_body, const Eigen::Vector3d& ahead_in_body) {
    up_in_body_ = up_in_body;
    assumed_forward_ = forward_facing_calibration(up_in_body, ahead_in_body);
  }
  // Sets the calibrated rotation of the gyroscope. Until it is estimated, it serves only to find the up axis from
  // accelerations at standstill.
  void set_gyroscope_extrinsics(const Eigen::Quaterniond& body_from_gyroscope);
  // Mode for making a map: keeps samples for up to half an hour instead of two minutes, and recomputes the poses of
  // untracked frames at the end from the final calibration. Before the first tracked frame, wheels yield motion with
  // the body assumed to look ahead: the distance is measured, the direction hardly.
  void enable_mapping_mode() {
    samples_kept_ = kMostKept;
    old_poses_ = GapTrajectory::OldPoses::recomputed;
    predicts_before_tracking_ = true;
  }

  // Samples are checked (MotionCheck); faulty ones are dropped.
  void add(const StampedPose& wheels);
  void add(const BaseTwist& wheels);
  void add(const AngularRate& rate);
  void add(const Acceleration& acceleration);
  // A motion of the body given by the caller; empty if it is faulty. seconds: its duration.
  std::optional<BodyMotion> checked(const BodyMotion& motion, Timestamp time, double seconds) {
    return check_.check(motion, time, seconds);
  }
  const std::vector<MotionWarning>& warnings() const { return check_.warnings(); }  // all so far
  void warn(const MotionWarning& warning) { check_.warn(warning); }
  bool is_empty() const { return wheels_.empty() && rates_.empty(); }
  bool has_wheels() const { return !wheels_.empty(); }

  // Focal length of the next frames' images over that of the given calibration.
  void set_focal_change(double factor) { focal_change_ = factor; }

  // Adds a frame with its smooth visual pose, in lengths of the map; empty if it was not tracked.
  void note(Timestamp time, const std::optional<Pose>& odometry_from_body);

  // Sets the map pose of the last noted frame. Call it only for trusted poses.
  void note_place(const Pose& map_from_body) { stationary_.note_place(map_from_body.rotation); }

  // Tilt of the body at the next frame from accelerations; empty unless wheels measure standstill until then.
  std::optional<BodyTilt> tilt(Timestamp time) const;

  // The body's motion between frames, in lengths of the map. A gyroscope alone measures only the rotation; the
  // translation then continues the last visual velocity, for 1 s at most. Empty if unknown.
  std::optional<BodyMotion> between(Timestamp earlier, Timestamp later) const;

  // Motion between frames that may be long past, with the present estimates: translation from wheels, rotation from the
  // gyroscope if available.
  std::optional<BodyMotion> path_between(Timestamp earlier, Timestamp later) const;

  // Upper bound of the body's displacement, in lengths of the map, by the distance that the wheels measured. Empty if
  // unknown. is_metric: the map's lengths are metres, so that the bound needs no calibration.
  std::optional<double> reach(Timestamp earlier, Timestamp later, bool is_metric) const;

  // Counts frames as tracked that were located in the finished map, by ascending times.
  void note_located(const std::vector<Timestamp>& times) { gaps_.note_located(times); }

  // Delay and calibration of the wheels by the final map poses of the tracked frames, after the last frame. Poses of
  // untracked frames are ignored, because wheels themselves determined them. If they contradict given extrinsics, these
  // are reported and dropped. Returns whether the map should be finished again, as it was without wheels, or with wrong
  // extrinsics. may_finish_again: the map can be; a rough estimate is then used for it.
  bool reestimate(const Trajectory& seen, bool may_finish_again);

  // After reestimate: lengths of the map are multiplied by this factor from here on.
  void rescale(double factor);

  // The final poses of tracked frames, and those of untracked frames which wheels connect to them.
  Trajectory fill_gaps(Trajectory seen) const;

  // Turns in images of the given focal length as a share of the turns by wheels, over the last minutes; empty with few
  // turns. Far from one, the focal length or the wheels' track width is wrong.
  struct TurnRatio {
    double value = 1.0;
    double sigma = 0.0;
  };
  std::optional<TurnRatio> turn_ratio() const;

  const std::optional<WheelCalibration>& wheels() const { return wheel_calibration_; }
  const StationaryDetector& stationary() const { return stationary_; }
  const std::optional<GyroscopeCalibration>& gyroscope() const { return gyroscope_; }
  // Delay of wheel stamps against the camera's, seconds.
  double time_offset() const { return time_offset_.value_or(0.0); }
  bool are_wheels_slipping() const { return slip_.is_present; }
  int slips() const { return slip_.count; }  // number of periods of slip
  // The calibration of wheels differs from that of the earlier drive.
  bool has_calibration_changed() const { return has_calibration_changed_; }
  // Calibration for the next drive: the estimates, or the earlier ones if not contradicted.
  OdometryCalibration calibration_to_store() const;

 private:
  static constexpr Timestamp kUsuallyKept = std::chrono::minutes(2);
  static constexpr Timestamp kMostKept = std::chrono::minutes(30);  // limit also while there is no calibration

  void compare_turns(Timestamp time, const std::optional<VisualMotion>& seen);
  void drop_wheels();
  void drop_gyroscope();
  void forget_old_samples();
  void update_standstill(Timestamp time, const std::optional<Pose>& seen);
  void estimate_calibrations();
  std::deque<VisualMotion> undistorted_motions() const;
  void set_wheels(WheelCalibration found);
  void estimate_wheels();
  void update_initial_calibration();
  const WheelCalibration* active_calibration() const;  // nullptr if nothing is estimated or assumed
  void detect_slip(const VisualMotion& motion);
  void check_prior(double disagreement, const VisualMotion& motion);
  void reestimate(const std::deque<VisualMotion>& motions);
  std::optional<WheelCalibration> prior_of_map() const;  // its scale is unknown if the map is not metric
  void estimate_time_offset(const std::deque<VisualMotion>& seen, const Eigen::Vector3d& up_in_body);
  void set_time_offset(double seconds);
  void discard_prior_wheels(Timestamp time);
  CalibratedOdometry odometry() const;
  void integrate(GapTrajectory& gaps) const;

  MotionCheck check_;
  bool is_metric_ = false;
  std::optional<Timestamp> turns_compared_;  // end of the last comparison of wheels and gyroscope without images
  WheelTrack wheels_;
  RateTrack rates_;
  StationaryDetector stationary_;
  Timestamp samples_kept_ = kUsuallyKept;
  GapTrajectory gaps_;
  GapTrajectory::OldPoses old_poses_ = GapTrajectory::OldPoses::kept;
  std::deque<VisualMotion> seen_;             // motions of the last minutes, half a second each
  std::optional<VisualMotion> metric_start_;  // see begin_metric
  std::optional<StampedPose> begin_;          // first frame of the motion in progress
  std::optional<StampedPose> last_;           // last frame, if tracked
  double focal_change_ = 1.0;
  std::optional<Vector6> velocity_;  // last visual velocity of the body, per second
  int motions_since_estimate_ = 0;   // tracked motions since the last estimation
  int estimates_ = 0;                // number of estimations that yielded a calibration of wheels
  std::optional<WheelCalibration> wheel_calibration_;
  std::optional<Eigen::Vector3d> up_in_body_;
  std::optional<WheelCalibration> initial_;          // only without wheel_calibration_
  std::optional<WheelCalibration> assumed_forward_;  // until the first tracked frame
  bool predicts_before_tracking_ = false;
  std::optional<Eigen::Vector3d> measured_up_;  // measured by accelerations
  std::optional<GyroscopeCalibration> given_gyroscope_;
  std::optional<GyroscopeCalibration> gyroscope_;
  std::optional<double> time_offset_;
  double time_offset_sigma_ = 0.05;  // seconds; usual until it is given or estimated
  struct Slip {
    bool is_present = false;
    int agreeing = 0;  // number of motions since slip in which wheels agree with images
    int count = 0;     // periods of slip
  };
  Slip slip_;
  struct Prior {
    OdometryCalibration calibration;  // from an earlier drive, until contradicted
    bool is_measured = false;         // by hand, not on an earlier drive
    bool is_assumed = false;          // see begin_metric
    int contradicting = 0;            // number of motions that contradict it
    int confirming = 0;               // number of motions that agree with it
    int contradicting_estimates = 0;  // consecutive estimates that contradict it
  };
  Prior prior_;
  bool has_calibration_changed_ = false;
};

}  // namespace byre
