#include "byre/simulation/motion_sensors.h"

#include "byre/simulation/seeded_draws.h"

#include <cmath>
#include <numbers>

namespace byre {
namespace {

constexpr std::uint64_t kWheelStream = 71;
constexpr std::uint64_t kRateStream = 72;
constexpr std::uint64_t kAccelerationStream = 73;
constexpr double kGravity = 9.81;  // m/s^2

// Normally distributed (Box-Muller).
double normal(SeededDraws& draws) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - static_cast<double>(draws.between(0.0f, 1.0f))));
  return radius * std::cos(2.0 * std::numbers::pi * static_cast<double>(draws.between(0.0f, 1.0f)));
}

class Wheel {
 public:
  Wheel(double scale, const MotionSensorOptions& options) : scale_(scale), options_(options) {}

  // Odometry increment in whole encoder ticks for a rolled distance, both in metres.
  double roll(double metres, SeededDraws& draws) {
    distance_ += scale_ * metres * (1.0 + options_.slip * normal(draws));
    const double ticks = std::floor(distance_ / options_.tick);
    const double measured = (ticks - ticks_) * options_.tick;
    ticks_ = ticks;
    return measured;
  }

 private:
  double scale_;
  MotionSensorOptions options_;
  double distance_ = 0.0;  // metres of odometry
  double ticks_ = 0.0;
};

// Differential-drive odometry: an arc between samples.
Trajectory simulate_wheel_odometry(const Trajectory& truth, const MotionSensorOptions& options) {
  constexpr double kFreeSpeed = 1.0;  // metres per second of a spinning wheel
  SeededDraws draws(options.seed, kWheelStream);
  const double measured = 1.0 / (1.0 - options.radius_error), half = 0.5 * options.radius_difference;
  Wheel left(measured * (1.0 - half), options), right(measured * (1.0 + half), options);
  const Timestamp start = truth.front().time, end = truth.back().time, step = from_seconds(1.0 / options.wheel_rate_hz);
  Trajectory wheels;
  Pose pose;
  for (Timestamp time = start; time + step <= end; time += step) {
    const auto before = pose_at(truth, time, step), after = pose_at(truth, time + step, step);
    if (!before || !after) continue;
    wheels.push_back({time + from_seconds(options.wheel_delay), pose});
    const Pose motion = inverse(*before) * *after;
    const double turn = rotation_log(motion.rotation).z(), displacement = motion.translation.x();
    const double seconds = to_seconds(time - start);
    const bool is_lifted = seconds >= options.lifted_from && seconds < options.lifted_to;
    const double left_distance =
        is_lifted ? kFreeSpeed * to_seconds(step) : displacement - 0.5 * options.wheel_distance * turn;
    const double left_measured = left.roll(left_distance, draws);
    const double right_measured = right.roll(displacement + 0.5 * options.wheel_distance * turn, draws);
    const double measured_turn = (right_measured - left_measured) / options.wheel_distance;
    const double measured_distance = 0.5 * (left_measured + right_measured);
    const Eigen::Vector3d arc(measured_distance * std::cos(0.5 * measured_turn),
                              measured_distance * std::sin(0.5 * measured_turn), 0.0);
    pose = pose * Pose{rotation_exp({0.0, 0.0, measured_turn}), arc};
  }
  return wheels;
}

Eigen::Vector3d normal_vector(double sigma, SeededDraws& draws) {
  Eigen::Vector3d vector;
  for (int axis = 0; axis < 3; ++axis) vector[axis] = sigma * normal(draws);
  return vector;
}

std::vector<AngularRate> simulate_gyroscope(const Trajectory& truth, const MotionSensorOptions& options) {
  SeededDraws draws(options.seed, kRateStream);
  const Eigen::Vector3d bias = normal_vector(options.rate_bias, draws);
  std::vector<AngularRate> rates;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    const double seconds = to_seconds(truth[i + 1].time - truth[i].time);
    const Pose motion = inverse(truth[i].world_from_body) * truth[i + 1].world_from_body;
    AngularRate rate{truth[i].time, rotation_log(motion.rotation) / seconds + bias};
    const double sigma = options.rate_noise / std::sqrt(seconds);
    rate.rate += normal_vector(sigma, draws);
    rates.push_back(rate);
  }
  return rates;
}

// Velocity from pose i to the next, metres per second.
Eigen::Vector3d velocity_after(const Trajectory& truth, std::size_t i) {
  const Eigen::Vector3d displacement = truth[i + 1].world_from_body.translation - truth[i].world_from_body.translation;
  return displacement / to_seconds(truth[i + 1].time - truth[i].time);
}

std::vector<Acceleration> simulate_accelerometer(const Trajectory& truth, const MotionSensorOptions& options) {
  SeededDraws draws(options.seed, kAccelerationStream);
  const Eigen::Vector3d bias = normal_vector(options.acceleration_bias, draws);
  std::vector<Acceleration> accelerations;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    const double seconds = to_seconds(truth[i + 1].time - truth[i].time);
    Eigen::Vector3d in_world(0.0, 0.0, kGravity);
    if (i > 0) {
      const double between = 0.5 * to_seconds(truth[i + 1].time - truth[i - 1].time);
      in_world += (velocity_after(truth, i) - velocity_after(truth, i - 1)) / between;
    }
    Acceleration measured{truth[i].time, truth[i].world_from_body.rotation.conjugate() * in_world + bias};
    const double sigma = options.acceleration_noise / std::sqrt(seconds);
    for (int axis = 0; axis < 3; ++axis) measured.acceleration[axis] += sigma * normal(draws);
    accelerations.push_back(measured);
  }
  return accelerations;
}

}  // namespace

MotionSamples simulate_motion(const Trajectory& world_from_body, const MotionSensorOptions& options) {
  if (world_from_body.size() < 2) return {};
  MotionSamples measured;
  measured.wheels = simulate_wheel_odometry(world_from_body, options);
  measured.rates = simulate_gyroscope(world_from_body, options);
  measured.accelerations = simulate_accelerometer(world_from_body, options);
  return measured;
}

}  // namespace byre
