#pragma once

#include "byre/body_motion.h"
#include "byre/motion_warning.h"
#include "byre/trajectory.h"

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace byre {

// Largest plausible values of samples.
struct MotionLimits {
  double max_speed = 10.0;          // speed of the robot's base, metres per second
  double max_turn_rate = 15.0;      // turn rate of the base and of a gyroscope, radians per second
  double max_acceleration = 100.0;  // acceleration by an accelerometer, m/s^2
  double max_position = 1e6;        // distance from the origin of wheel odometry, metres
};

// Whether all numbers are finite, the quaternion has a length of about 1, and each variance is between 0 and 1e12.
bool is_sound(const BodyMotion& motion);

// Checks the order of the stamps of one sensor.
class StampCheck {
 public:
  enum class Order : std::uint8_t {
    next,      // later than the previous sample
    dropped,   // not later, out of range, or a leap ahead that no second stamp confirms yet
    restarted  // the clock was set back: ten ascending stamps, all earlier than those before
  };
  Order check(Timestamp time);

 private:
  std::optional<Timestamp> last_;
  std::optional<Timestamp> ahead_;  // unconfirmed leap ahead
  std::optional<Timestamp> late_;   // last stamp that was not later than last_
  int late_count_ = 0;              // number of such stamps in a row, ascending
};

// Checks samples of wheels, gyroscope and accelerometer on input: finite, plausible in size, speed and rate, in order
// of time, in the expected unit. Each kind of fault yields one warning. An input in a wrong unit, or without a signal,
// is ignored from then on.
class MotionCheck {
 public:
  explicit MotionCheck(const MotionLimits& limits = {}) : limits_(limits) {}

  // Wheel poses to use. A jump begins a new segment of odometry once a second pose confirms it. A single outlier is
  // dropped.
  struct CheckedPoses {
    bool is_clock_set_back = false;          // earlier samples are of another clock setting
    std::optional<StampedPose> beginning{};  // first pose of a new segment, before sample
    std::optional<StampedPose> sample{};
  };
  CheckedPoses check(const StampedPose& wheels);

  // dropped: the sample must not be used; restarted: it is the first to use after the clock was set back.
  StampCheck::Order check(const BaseTwist& wheels);
  StampCheck::Order check(const AngularRate& rate);
  StampCheck::Order check(const Acceleration& acceleration);
  // The motion with a normalised rotation; empty if it is not finite, or too large for the time. seconds: its duration.
  std::optional<BodyMotion> check(const BodyMotion& motion, Timestamp time, double seconds);

  // The same turn measured by the gyroscope and otherwise.
  struct Turn {
    Timestamp time{};                         // end of the turn
    Eigen::Vector3d reference;                // radians, about any axes
    std::optional<Eigen::Vector3d> measured;  // radians, by the gyroscope with its bias
    bool is_seen = false;                     // reference from images; false: from wheels, which may slip
  };
  // Compares both; true if this turn shows the gyroscope to be faulty, for the first time.
  bool note(const Turn& turn);

  // Compares the wheels with lengths measured otherwise. metres_per_unit: scale of these lengths from wheels. True if
  // wheels are ignored from now on.
  bool note_wheel_scale(double metres_per_unit, double sigma, Timestamp time);

  // All samples so far are zero, and are not used.
  bool is_gyroscope_silent() const { return rate_count_ > 0 && !has_rate_; }
  bool are_wheels_ignored() const { return ignored_.contains(MotionSensor::wheels); }

  void warn(const MotionWarning& warning) { warnings_.push_back(warning); }  // adds a fault found elsewhere
  const std::vector<MotionWarning>& warnings() const { return warnings_; }   // all so far

 private:
  enum class Fault : std::uint8_t { not_finite, too_large, jump, frozen, spike, clock, unit, silent, scale };

  void warn_once(MotionSensor sensor, Fault fault, Timestamp time, const std::string& what, const std::string& remedy);
  StampCheck::Order ordered(StampCheck& stamps, MotionSensor sensor, Timestamp time);
  bool is_step(const StampedPose& from, const StampedPose& to) const;
  void accept(const StampedPose& sample);
  bool is_frozen(const StampedPose& sample);
  void note_speed(Timestamp time, double way, double seconds);
  void note_unit_of_acceleration(const Acceleration& acceleration);
  bool ignore_gyroscope(Fault fault, Timestamp time, const std::string& what, const std::string& remedy);

  MotionLimits limits_;  // constant after construction

  std::vector<MotionWarning> warnings_;
  std::set<std::pair<MotionSensor, Fault>> warned_;
  std::set<MotionSensor> ignored_;

  StampCheck wheel_stamps_, velocity_stamps_, rate_stamps_, acceleration_stamps_;

  std::optional<StampedPose> raw_;        // last finite wheel pose
  std::optional<StampedPose> last_;       // last accepted wheel pose
  std::optional<StampedPose> suspected_;  // pose after an unconfirmed jump
  std::optional<double> speed_;           // recent maximum, metres per second
  std::optional<double> turn_rate_;       // recent maximum, radians per second
  double mean_speed_ = 0.0;               // mean over recent wheel poses, metres per second
  double last_step_speed_ = 0.0;          // speed of the last step between different poses, metres per second
  double speed_before_same_ = 0.0;        // mean speed when the last run of equal poses began
  std::optional<Timestamp> pose_since_;   // first sample of the present run of equal poses
  double longest_run_ = 0.0;              // longest run while driving, seconds; drivers may repeat each pose
  bool is_frozen_ = false;
  double fast_share_ = 0.0;  // share of recent samples above the speed limit

  std::optional<Eigen::Vector3d> last_rate_;
  int rate_count_ = 0;
  bool has_rate_ = false;                // whether any rate was not zero
  std::optional<Timestamp> same_since_;  // first rate of the present run of rates equal to the last bit
  std::optional<Timestamp> rate_time_;   // time of the last rate
  double fast_rate_share_ = 0.0;         // share of recent rates above the limit
  bool has_dead_zone_ = false;           // rates were equal for a while when the robot did not turn
  double turned_while_same_ = 0.0;       // turn by the reference during the present run, radians
  std::optional<Turn> last_turn_;
  double measured_change_ = 0.0, reference_change_ = 0.0;  // sums of changes between consecutive turns, radians
  int changes_ = 0;

  int acceleration_count_ = 0;
  double acceleration_sum_ = 0.0;  // m/s^2
};

}  // namespace byre
