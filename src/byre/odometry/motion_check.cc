#include "byre/odometry/motion_check.h"

#include "byre/geometry/degrees.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kLatestStamp = Timestamp::max() / 2;  // differences of stamps stay in range
constexpr Timestamp kLeap = 10s;                          // a larger step ahead needs confirmation by a second stamp
constexpr int kLateUntilRestarted = 10;                   // ascending stamps in a row
constexpr double kLeastRecent = 0.02;                     // seconds, least duration for speeds, because stamps jitter
constexpr double kFastShareOfUnit = 0.5;  // share of samples above the limit from which the unit is wrong
constexpr double kDegreesPerRadian = 1.0 / kDegree;

bool is_rotation(const Eigen::Quaterniond& rotation) {
  constexpr double kMostOff = 0.1;  // largest error of the length 1
  return rotation.coeffs().allFinite() && std::abs(rotation.norm() - 1.0) < kMostOff;
}

// Normalises; leaves a unit quaternion unchanged to the last bit.
Eigen::Quaterniond unit(const Eigen::Quaterniond& rotation) {
  constexpr double kRounding = 1e-9;
  return std::abs(rotation.squaredNorm() - 1.0) < kRounding ? rotation : rotation.normalized();
}

double distance(const StampedPose& from, const StampedPose& to) {
  return (to.world_from_body.translation - from.world_from_body.translation).norm();
}

double turn(const StampedPose& from, const StampedPose& to) {
  return angle_between(from.world_from_body.rotation, to.world_from_body.rotation);
}

// Restarted drivers of a base publish exactly this pose first.
bool is_origin(const StampedPose& sample) {
  constexpr double kRounding = 1e-6;  // metres and radians
  return sample.world_from_body.translation.norm() < kRounding &&
         sample.world_from_body.rotation.vec().norm() < kRounding;
}

}  // namespace

StampCheck::Order StampCheck::check(Timestamp time) {
  if (time > kLatestStamp || time < -kLatestStamp) return Order::dropped;
  if (last_ && time <= *last_) {
    late_count_ = late_ && time > *late_ ? late_count_ + 1 : 1;
    late_ = time;
    if (late_count_ < kLateUntilRestarted) return Order::dropped;
    *this = {};
    last_ = time;
    return Order::restarted;
  }
  late_.reset();
  late_count_ = 0;
  const bool is_confirmed = ahead_ && time > *ahead_ && time - *ahead_ <= kLeap;
  if (last_ && time - *last_ > kLeap && !is_confirmed) {
    ahead_ = time;
    return Order::dropped;
  }
  ahead_.reset();
  last_ = time;
  return Order::next;
}

bool is_sound(const BodyMotion& motion) {
  constexpr double kMostVariance = 1e12;  // square metres and square radians, so that sums and products stay finite
  const auto& [pose, covariance] = motion;
  return pose.translation.allFinite() && is_rotation(pose.rotation) && covariance.allFinite() &&
         (covariance.diagonal().array() >= 0.0).all() && (covariance.array().abs() <= kMostVariance).all();
}

void MotionCheck::warn_once(MotionSensor sensor, Fault fault, Timestamp time, const std::string& what,
                            const std::string& remedy) {
  if (warned_.emplace(sensor, fault).second) warnings_.push_back({sensor, time, what, remedy});
}

StampCheck::Order MotionCheck::ordered(StampCheck& stamps, MotionSensor sensor, Timestamp time) {
  const StampCheck::Order order = stamps.check(time);
  if (order == StampCheck::Order::restarted) {
    warn_once(sensor, Fault::clock, time, "the clock was set back; earlier samples are discarded",
              "do not set the clock while the driver runs");
  }
  return order;
}

// Whether a base can make the step. The speed limit follows the recent speed, so that resets near the origin are
// detected too.
bool MotionCheck::is_step(const StampedPose& from, const StampedPose& to) const {
  constexpr double kSlack = 0.05;       // metres, for encoder ticks and late stamps
  constexpr double kSlackTurn = 0.1;    // radians
  constexpr double kFaster = 1.5;       // factor of the recent speed
  constexpr double kMoreSpeed = 3.0;    // metres per second added to it, for wheels that begin to spin
  constexpr double kMoreTurning = 3.0;  // radians per second added to the turn rate
  const double seconds = to_seconds(to.time - from.time);
  const double speed = speed_ ? std::min(limits_.max_speed, kFaster * *speed_ + kMoreSpeed) : limits_.max_speed;
  const double turning =
      turn_rate_ ? std::min(limits_.max_turn_rate, kFaster * *turn_rate_ + kMoreTurning) : limits_.max_turn_rate;
  const bool is_restart = is_origin(to) && !is_origin(from) && (distance(from, to) > 1e-3 || turn(from, to) > 1e-3);
  return !is_restart && distance(from, to) <= kSlack + speed * seconds &&
         turn(from, to) <= kSlackTurn + turning * seconds;
}

void MotionCheck::accept(const StampedPose& sample) {
  constexpr double kKept = 0.9;  // decay of the recent maximum per sample
  if (last_) {
    const double seconds = std::max(kLeastRecent, to_seconds(sample.time - last_->time));
    speed_ = std::max(distance(*last_, sample) / seconds, kKept * speed_.value_or(0.0));
    turn_rate_ = std::max(turn(*last_, sample) / seconds, kKept * turn_rate_.value_or(0.0));
  }
  last_ = sample;
  suspected_.reset();
}

// Whether the driver has stopped: the pose stays equal to the last bit although the base drove too fast to brake.
bool MotionCheck::is_frozen(const StampedPose& sample) {
  constexpr double kHardestBraking = 8.0;  // m/s^2
  constexpr double kLeastSpeed = 0.15;     // metres per second
  constexpr double kLeastRun = 0.055;      // seconds
  constexpr double kRuns = 3.0;            // factor of the longest run while driving
  constexpr double kLongestRun = 0.3;      // seconds; longer runs are stops
  constexpr double kNew = 0.2;             // weight of a sample in the mean
  const double seconds = std::max(1e-3, to_seconds(sample.time - raw_->time));
  const double run = pose_since_ ? to_seconds(raw_->time - *pose_since_) : 0.0;
  if (!(sample.world_from_body == raw_->world_from_body)) {
    if (run > 0.0 && run <= kLongestRun) longest_run_ = std::max(longest_run_, run);
    last_step_speed_ = distance(*raw_, sample) / std::max(kLeastRecent, seconds);
    mean_speed_ += kNew * (last_step_speed_ - mean_speed_);
    pose_since_ = sample.time;
    return false;
  }
  if (run == 0.0) speed_before_same_ = std::min(mean_speed_, last_step_speed_);
  mean_speed_ -= kNew * mean_speed_;
  const double longest = std::max(longest_run_, seconds);
  if (speed_before_same_ < std::max(kLeastSpeed, kHardestBraking * longest)) return false;
  return pose_since_ && to_seconds(sample.time - *pose_since_) > kLeastRun + kRuns * longest_run_;
}

// Speeds above the limit for many samples mean another unit; a jump lasts for one sample only.
void MotionCheck::note_speed(Timestamp time, double way, double seconds) {
  constexpr double kSlack = 0.05;  // metres
  constexpr double kNew = 0.04;    // weight of a sample
  constexpr double kMillimetres = 300.0;
  const bool is_fast = way > kSlack + limits_.max_speed * seconds;
  fast_share_ += kNew * ((is_fast ? 1.0 : 0.0) - fast_share_);
  if (fast_share_ < kFastShareOfUnit) return;
  const double speed = way / std::max(kLeastRecent, seconds);
  ignored_.insert(MotionSensor::wheels);
  warn_once(
      MotionSensor::wheels, Fault::unit, time,
      fmt::format("the base moves at {:.3g} m/s, above motion.max_speed_m_per_s ({:.3g}), in many samples; wheels are "
                  "ignored",
                  speed, limits_.max_speed),
      std::string("give lengths in metres: these look like ") + (speed > kMillimetres ? "millimetres" : "centimetres") +
          ", or raise the limit for a faster vehicle");
}

MotionCheck::CheckedPoses MotionCheck::check(const StampedPose& wheels) {
  constexpr auto kWheels = MotionSensor::wheels;
  if (are_wheels_ignored()) return {};
  const Pose& pose = wheels.world_from_body;
  if (!pose.translation.allFinite() || !is_rotation(pose.rotation)) {
    warn_once(kWheels, Fault::not_finite, wheels.time,
              "a pose is not finite, or its quaternion is not of length 1; such poses are dropped",
              "check the output of the base driver");
    return {};
  }
  const double farthest = pose.translation.lpNorm<Eigen::Infinity>();  // a norm would overflow
  if (farthest > limits_.max_position) {
    warn_once(
        kWheels, Fault::too_large, wheels.time,
        fmt::format("a pose is {:.3g} m from the origin, more than motion.max_position_m ({:.3g}); such poses are "
                    "dropped",
                    farthest, limits_.max_position),
        "check the output of the base driver");
    return {};
  }
  CheckedPoses result;
  const StampCheck::Order order = ordered(wheel_stamps_, kWheels, wheels.time);
  if (order == StampCheck::Order::dropped) return {};
  if (order == StampCheck::Order::restarted) {
    result.is_clock_set_back = true;
    raw_.reset();
    last_.reset();
    suspected_.reset();
  }
  const StampedPose sample{wheels.time, {unit(pose.rotation), pose.translation}};
  const bool was_frozen = is_frozen_;
  if (raw_) {
    note_speed(sample.time, distance(*raw_, sample), to_seconds(sample.time - raw_->time));
    is_frozen_ = is_frozen(sample);
  }
  raw_ = sample;
  if (are_wheels_ignored()) return {};
  if (is_frozen_) {
    warn_once(kWheels, Fault::frozen, sample.time,
              fmt::format("the pose stays the same to the last bit right after {:.2f} m/s; such poses are ignored",
                          speed_before_same_),
              "check that the base driver is running");
    return result;
  }
  if (was_frozen) {  // the motion since then is unknown
    result.beginning = sample;
    last_ = sample;
    suspected_.reset();
    speed_.reset();
    turn_rate_.reset();
    return result;
  }
  const bool follows = !last_ || is_step(*last_, sample);
  const bool confirms = suspected_ && is_step(*suspected_, sample) &&
                        (!follows || distance(*suspected_, sample) < distance(*last_, sample));
  if (!follows && !confirms) {
    suspected_ = sample;
    return result;
  }
  if (confirms) {
    const StampedPose &before = *last_, &after = *suspected_;
    warn_once(kWheels, Fault::jump, after.time,
              fmt::format("the pose jumps by {:.3g} m and {:.0f} degrees in {:.3f} s; motion across a jump is ignored",
                          distance(before, after), turn(before, after) * kDegreesPerRadian,
                          to_seconds(after.time - before.time)),
              "check whether the base driver restarts, or two nodes publish the topic");
    result.beginning = suspected_;
    last_ = suspected_;
    speed_.reset();
    turn_rate_.reset();
  } else if (suspected_) {
    warn_once(
        kWheels, Fault::spike, suspected_->time,
        fmt::format("a single pose is {:.3g} m off the path; such poses are dropped", distance(*last_, *suspected_)),
        "check the encoder wiring for noise, and the topic for a second publisher");
  }
  accept(sample);
  result.sample = sample;
  return result;
}

StampCheck::Order MotionCheck::check(const BaseTwist& wheels) {
  constexpr auto kWheels = MotionSensor::wheels;
  const auto dropped = StampCheck::Order::dropped;
  if (are_wheels_ignored()) return dropped;
  const double speed = std::hypot(wheels.vx, wheels.vy);
  if (!std::isfinite(speed) || !std::isfinite(wheels.wz)) {
    warn_once(kWheels, Fault::not_finite, wheels.time, "a velocity is not finite; such velocities are dropped",
              "check the output of the base driver");
    return dropped;
  }
  note_speed(wheels.time, speed * kLeastRecent, kLeastRecent);
  if (are_wheels_ignored()) return dropped;
  if (speed > limits_.max_speed || std::abs(wheels.wz) > limits_.max_turn_rate) {
    warn_once(kWheels, Fault::too_large, wheels.time,
              fmt::format("a velocity of {:.3g} m/s and {:.3g} rad/s is above motion.max_speed_m_per_s ({:.3g}) or "
                          "motion.max_turn_rate_rad_per_s ({:.3g}); such velocities are dropped",
                          speed, wheels.wz, limits_.max_speed, limits_.max_turn_rate),
              "check the output of the base driver");
    return dropped;
  }
  return ordered(velocity_stamps_, kWheels, wheels.time);
}

bool MotionCheck::ignore_gyroscope(Fault fault, Timestamp time, const std::string& what, const std::string& remedy) {
  ignored_.insert(MotionSensor::gyroscope);
  warn_once(MotionSensor::gyroscope, fault, time, what + "; the gyroscope is ignored", remedy);
  return true;
}

StampCheck::Order MotionCheck::check(const AngularRate& rate) {
  constexpr auto kGyroscope = MotionSensor::gyroscope;
  constexpr double kNew = 0.01;  // weight of a sample
  const auto dropped = StampCheck::Order::dropped;
  if (ignored_.contains(kGyroscope)) return dropped;
  if (!rate.rate.allFinite()) {
    warn_once(kGyroscope, Fault::not_finite, rate.time, "a rate is not finite; such rates are dropped",
              "check the output of the IMU driver");
    return dropped;
  }
  const bool is_fast = !(rate.rate.norm() <= limits_.max_turn_rate);
  fast_rate_share_ += kNew * ((is_fast ? 1.0 : 0.0) - fast_rate_share_);
  if (fast_rate_share_ > kFastShareOfUnit) {
    ignore_gyroscope(
        Fault::unit, rate.time,
        fmt::format("rates are above motion.max_turn_rate_rad_per_s ({:.3g}) in many samples", limits_.max_turn_rate),
        "give radians per second: these look like degrees per second");
    return dropped;
  }
  if (is_fast) {
    warn_once(
        kGyroscope, Fault::too_large, rate.time,
        fmt::format("a rate of {:.3g} rad/s is above motion.max_turn_rate_rad_per_s ({:.3g}); such rates are dropped",
                    rate.rate.norm(), limits_.max_turn_rate),
        "give radians per second, or raise the limit");
    return dropped;
  }
  const StampCheck::Order order = ordered(rate_stamps_, kGyroscope, rate.time);
  if (order == dropped) return order;
  ++rate_count_;
  rate_time_ = rate.time;
  has_rate_ = has_rate_ || !rate.rate.isZero(0.0);
  if (!last_rate_ || *last_rate_ != rate.rate || order == StampCheck::Order::restarted) {
    same_since_ = rate.time;
    turned_while_same_ = 0.0;
  }
  last_rate_ = rate.rate;
  return has_rate_ ? order : dropped;
}

bool MotionCheck::note(const Turn& turn) {
  constexpr Timestamp kSame = 400ms;         // least duration of a run of equal rates
  constexpr double kTurn = 0.03;             // radians; smaller turns may be noise
  constexpr double kTurnedWhileSame = 0.15;  // radians by the reference, from which equal rates are a fault
  constexpr double kTurning = 0.05;          // radians, least change between consecutive turns
  constexpr double kEnoughDegrees = 0.15;    // radians of change by the reference, to detect degrees
  constexpr double kEnough = 1.0;            // radians of change, to detect another factor
  constexpr int kFewChanges = 2, kManyChanges = 6;
  if (ignored_.contains(MotionSensor::gyroscope)) return false;
  if (rate_time_ && same_since_ && *rate_time_ - *same_since_ >= kSame && *same_since_ < turn.time) {
    const bool is_turn = turn.reference.norm() >= kTurn;
    if (!is_turn) has_dead_zone_ = true;
    const bool counts = turn.is_seen || !has_rate_ || !has_dead_zone_;  // a wheel may spin at standstill
    if (is_turn && counts) turned_while_same_ += turn.reference.norm();
    if (turned_while_same_ >= kTurnedWhileSame) {
      return ignore_gyroscope(
          Fault::silent, turn.time,
          fmt::format("all rates are {} while the robot turns by {:.0f} degrees",
                      last_rate_->isZero(0.0) ? "zero" : "equal", turned_while_same_ * kDegreesPerRadian),
          "choose the topic or file of the gyroscope, not that of an accelerometer alone, and check that the sensor "
          "works");
    }
  }
  const std::optional<Turn> before = std::exchange(last_turn_, turn);
  if (!before || !before->measured || !turn.measured) return false;
  const double measured = (*turn.measured - *before->measured).norm();
  const double reference = (turn.reference - before->reference).norm();
  if (std::max(measured, reference) < kTurning) return false;
  measured_change_ += measured;
  reference_change_ += reference;
  ++changes_;
  const double ratio = measured_change_ / std::max(reference_change_, 1e-9);
  const bool is_in_degrees = ratio > 0.5 * kDegreesPerRadian && ratio < 2.0 * kDegreesPerRadian;
  if (is_in_degrees && changes_ >= kFewChanges && reference_change_ >= kEnoughDegrees) {
    return ignore_gyroscope(Fault::unit, turn.time,
                            fmt::format("rates are {:.0f} times the rotation of the robot", ratio),
                            "give radians per second: these are degrees per second");
  }
  const bool is_enough =
      turn.is_seen && changes_ >= kManyChanges && std::max(measured_change_, reference_change_) >= kEnough;
  if (is_enough && (ratio > 3.0 || ratio < 1.0 / 3.0)) {
    return ignore_gyroscope(
        Fault::unit, turn.time, fmt::format("rates are {:.3g} times the rotation of the camera", ratio),
        is_in_degrees ? "give radians per second: these are degrees per second"
                      : "give radians per second, and check that the sensor is fixed to the cameras");
  }
  if (changes_ >= 2 * kManyChanges) {
    measured_change_ *= 0.5;
    reference_change_ *= 0.5;
    changes_ /= 2;
  }
  return false;
}

// Checks the unit by the mean length of the first samples, where motion averages out against gravity.
void MotionCheck::note_unit_of_acceleration(const Acceleration& acceleration) {
  constexpr int kSamples = 100;
  constexpr double kGravity = 9.81;  // m/s^2
  if (acceleration_count_ >= kSamples) return;
  acceleration_sum_ += acceleration.acceleration.norm();
  if (++acceleration_count_ < kSamples) return;
  const double mean = acceleration_sum_ / kSamples;
  if (mean > 0.5 * kGravity && mean < 2.0 * kGravity) return;
  const bool is_in_g = mean > 0.8 && mean < 1.25;
  ignored_.insert(MotionSensor::accelerometer);
  warn_once(
      MotionSensor::accelerometer, Fault::unit, acceleration.time,
      fmt::format("accelerations have a mean length of {:.3g}, but gravity is 9.81 m/s^2; the accelerometer is ignored",
                  mean),
      is_in_g ? "give m/s^2: these are multiples of g" : "give m/s^2 including gravity");
}

StampCheck::Order MotionCheck::check(const Acceleration& acceleration) {
  constexpr auto kAccelerometer = MotionSensor::accelerometer;
  const auto dropped = StampCheck::Order::dropped;
  if (ignored_.contains(kAccelerometer) || acceleration.acceleration.isZero(0.0)) return dropped;
  const double length = acceleration.acceleration.norm();
  if (!std::isfinite(length)) {
    warn_once(kAccelerometer, Fault::not_finite, acceleration.time,
              "an acceleration is not finite; such accelerations are dropped", "check the output of the IMU driver");
    return dropped;
  }
  if (length > limits_.max_acceleration) {
    warn_once(kAccelerometer, Fault::too_large, acceleration.time,
              fmt::format("an acceleration of {:.3g} m/s^2 is above motion.max_acceleration_m_per_s2 ({:.3g}); such "
                          "accelerations are dropped",
                          length, limits_.max_acceleration),
              "give m/s^2, or raise the limit");
    return dropped;
  }
  const StampCheck::Order order = ordered(acceleration_stamps_, kAccelerometer, acceleration.time);
  if (order == dropped) return order;
  note_unit_of_acceleration(acceleration);
  return ignored_.contains(kAccelerometer) ? dropped : order;
}

std::optional<BodyMotion> MotionCheck::check(const BodyMotion& motion, Timestamp time, double seconds) {
  constexpr double kSlack = 0.5;  // metres and radians
  if (!is_sound(motion)) {
    warn_once(MotionSensor::body_motion, Fault::not_finite, time,
              "the motion or its covariance is not finite, or its quaternion is not of length 1; it is ignored",
              "give a rotation of length 1 and a positive covariance");
    return {};
  }
  const double way = motion.last_from_body.translation.norm();
  if (way > kSlack + limits_.max_speed * std::max(0.0, seconds)) {
    warn_once(MotionSensor::body_motion, Fault::too_large, time,
              fmt::format("{:.3g} m in {:.3f} s is above motion.max_speed_m_per_s ({:.3g}); such motions are ignored",
                          way, seconds, limits_.max_speed),
              "give the motion since the last frame in metres, or raise the limit");
    return {};
  }
  BodyMotion sound = motion;
  sound.last_from_body.rotation = unit(motion.last_from_body.rotation);
  return sound;
}

bool MotionCheck::note_wheel_scale(double metres_per_unit, double sigma, Timestamp time) {
  constexpr double kLeast = 0.1;  // natural logarithm; worn tyres and coarse encoders err by less
  constexpr double kSigmas = 5.0;
  constexpr double kAnotherUnit = 2.0;
  const double off = std::log(metres_per_unit);
  if (!(std::abs(off) > std::max(kLeast, kSigmas * sigma)) || are_wheels_ignored()) return false;
  const bool is_unusable = std::abs(off) > std::log(kAnotherUnit);
  if (is_unusable) ignored_.insert(MotionSensor::wheels);
  const char* const unit_seen = metres_per_unit > 300.0  ? "these are millimetres"
                                : metres_per_unit > 30.0 ? "these are centimetres"
                                                         : "check the gear ratio and the wheel radius";
  warn_once(MotionSensor::wheels, is_unusable ? Fault::unit : Fault::scale, time,
            fmt::format("path lengths are {:.3g} times those of the cameras or the map; ", metres_per_unit) +
                (is_unusable ? "wheels are ignored" : "lengths of the cameras or the map are used"),
            is_unusable ? std::string("give lengths in metres: ") + unit_seen
                        : "calibrate the wheel radius, or check the baseline");
  return is_unusable;
}

}  // namespace byre
