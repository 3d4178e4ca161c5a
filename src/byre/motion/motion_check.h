#pragma once

#include "byre/body_motion.h"
#include "byre/motion_warning.h"

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace byre {

// Limits of plausible samples.
struct MotionLimits {
  double max_speed = 10.0;          // metres per second, of the robot's base
  double max_turn_rate = 15.0;      // radians per second, of the base and of a gyroscope
  double max_acceleration = 100.0;  // m/s^2, of an accelerometer
  double max_position = 1e6;        // metres from the origin of wheel odometry
};

// Whether all numbers are finite, the rotation is one, and each variance is between 0 and 1e12.
bool is_sound(const BodyMotion& motion);

// Order of the stamps of one sensor.
class StampCheck {
 public:
  enum class Order : std::uint8_t {
    next,      // later than the sample before
    dropped,   // not later, out of the range of a clock, or a leap ahead that no other stamp confirms yet
    restarted  // the clock was set back: ten samples in order, all earlier than those before
  };
  Order check(Timestamp time);

 private:
  std::optional<Timestamp> last_;
  std::optional<Timestamp> ahead_;  // unconfirmed leap ahead
  std::optional<Timestamp> late_;   // last stamp that was not later than last_
  int late_count_ = 0;              // such stamps in a row
};

// Checks samples of wheels, gyroscope and accelerometer as they enter: finite, plausible in size, speed and rate, in
// order of time, in the expected unit. Each kind of fault yields one warning. Samples of an input in a wrong unit, or
// that measures nothing, are ignored from then on.
class MotionCheck {
 public:
  explicit MotionCheck(const MotionLimits& limits = {}) : limits_(limits) {}

  // Wheel poses that may be used. A jump begins a new segment of odometry once a second pose confirms it; a single pose
  // away and back is dropped.
  struct CheckedPoses {
    bool is_clock_set_back = false;          // no earlier sample has the clock of this one
    std::optional<StampedPose> beginning{};  // first pose of a new segment, before sample
    std::optional<StampedPose> sample{};
  };
  CheckedPoses check(const StampedPose& wheels);

  // Whether the sample may be used; restarted: it is the first after the clock was set back.
  StampCheck::Order check(const BaseVelocity& wheels);
  StampCheck::Order check(const AngularRate& rate);
  StampCheck::Order check(const Acceleration& acceleration);
  // The motion with a normalised rotation; empty where it is not finite, or more than the limits allow in that time.
  std::optional<BodyMotion> check(const BodyMotion& motion, Timestamp time, double seconds);

  // Compares the gyroscope with another measurement of the same turn.
  struct Turn {
    Timestamp time{};                         // end of the turn
    Eigen::Vector3d reference;                // radians, about any axes
    std::optional<Eigen::Vector3d> measured;  // radians, by the gyroscope with its bias
    bool is_seen = false;                     // reference by images; otherwise by wheels, which may slip
  };
  // Whether the gyroscope is found faulty now, for the first time.
  bool note(const Turn& turn);

  // Compares wheels with metres known otherwise; metres_per_unit: lengths by wheels as a multiple of these.
  // Whether wheels are ignored from now on.
  bool note_wheel_scale(double metres_per_unit, double sigma, Timestamp time);

  // Samples came that are all zero, and may not be used.
  bool is_gyroscope_silent() const { return rate_count_ > 0 && !has_rate_; }
  bool are_wheels_ignored() const { return ignored_.contains(MotionSensor::wheels); }

  void warn(const MotionWarning& warning) { warnings_.push_back(warning); }  // a fault found elsewhere
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
  std::optional<StampedPose> last_;       // last wheel pose that was accepted
  std::optional<StampedPose> suspected_;  // a pose after a jump that nothing confirms yet
  std::optional<double> speed_;           // metres per second, recent
  std::optional<double> turn_rate_;       // radians per second, recent
  double mean_speed_ = 0.0;               // metres per second, of the last wheel poses
  double last_step_speed_ = 0.0;          // metres per second, of the last wheel pose that differs from the one before
  double speed_before_same_ = 0.0;        // mean speed when the last run of equal poses began
  std::optional<Timestamp> pose_since_;   // first sample of the present run
  double longest_run_ = 0.0;              // seconds; a driver may publish each pose several times
  bool is_frozen_ = false;
  double fast_share_ = 0.0;  // share of recent samples beyond the largest speed

  std::optional<Eigen::Vector3d> last_rate_;
  int rate_count_ = 0;
  bool has_rate_ = false;                // a rate that is not zero
  std::optional<Timestamp> same_since_;  // first of the rates in a row that are equal to the last bit
  std::optional<Timestamp> rate_time_;   // time of the last rate
  double fast_rate_share_ = 0.0;         // share of recent rates beyond the largest
  bool has_dead_zone_ = false;           // rates were equal for a while where the robot does not turn
  double turned_while_same_ = 0.0;       // radians by the reference
  std::optional<Turn> last_turn_;
  double measured_change_ = 0.0, reference_change_ = 0.0;  // radians, of turns from one to the next, summed
  int changes_ = 0;

  int acceleration_count_ = 0;
  double acceleration_sum_ = 0.0;  // m/s^2
};

// Samples whose times have nothing in common with those of the frames.
std::vector<MotionWarning> clock_warnings(const MotionSamples& samples, Timestamp first_frame, Timestamp last_frame);

// Note of a map whose metres wheels alone measured: "sigma_by_wheels SHARE", by the key kMetresNote.
inline constexpr const char* kMetresNote = "metres";
std::string metres_note(double sigma);

// Checks recorded samples without images: all of the above but the comparison with what is seen.
std::vector<MotionWarning> check_motion(const MotionSamples& samples, Timestamp first_frame, Timestamp last_frame,
                                        const MotionLimits& limits = {});

}  // namespace byre
