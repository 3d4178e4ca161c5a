#include "byre/odometry/recorded_motion.h"

#include "byre/odometry/rate_track.h"
#include "byre/odometry/wheel_track.h"

#include <chrono>

#include <fmt/format.h>

namespace byre {

using std::chrono_literals::operator""ms;

std::vector<MotionWarning> clock_warnings(const MotionSamples& samples, Timestamp first_frame, Timestamp last_frame) {
  std::vector<MotionWarning> warnings;
  const auto compare = [&](MotionSensor sensor, Timestamp first, Timestamp last) {
    if (first <= last_frame && last >= first_frame) return;
    warnings.push_back(
        {sensor,
         {},
         fmt::format("samples range from {:.3f} to {:.3f} s, but images from {:.3f} to {:.3f} s; no sample is used",
                     to_seconds(first), to_seconds(last), to_seconds(first_frame), to_seconds(last_frame)),
         "stamp both with one clock, or shift the times of one"});
  };
  if (!samples.wheels.empty()) compare(MotionSensor::wheels, samples.wheels.front().time, samples.wheels.back().time);
  if (!samples.velocities.empty()) {
    compare(MotionSensor::wheels, samples.velocities.front().time, samples.velocities.back().time);
  }
  if (!samples.rates.empty()) compare(MotionSensor::gyroscope, samples.rates.front().time, samples.rates.back().time);
  return warnings;
}

std::vector<MotionWarning> check_motion(const MotionSamples& samples, Timestamp first_frame, Timestamp last_frame,
                                        const MotionLimits& limits) {
  constexpr Timestamp kStride = 500ms;
  MotionCheck check(limits);
  WheelTrack wheels;
  for (const StampedPose& sample : samples.wheels) {
    const auto [is_clock_set_back, beginning, next] = check.check(sample);
    if (is_clock_set_back) wheels = {};
    if (beginning) wheels.begin_segment(*beginning);
    if (next) wheels.add(*next);
  }
  for (const BaseTwist& sample : samples.velocities) {
    const StampCheck::Order order = check.check(sample);
    if (order == StampCheck::Order::restarted) wheels = {};
    if (order != StampCheck::Order::dropped) wheels.add(sample);
  }
  RateTrack rates;
  Timestamp begin = first_frame;
  for (const AngularRate& sample : samples.rates) {
    const StampCheck::Order order = check.check(sample);
    if (order == StampCheck::Order::restarted) {
      rates = {};
      begin = sample.time;
    }
    if (order != StampCheck::Order::dropped) rates.add(sample);
    if (sample.time - begin < kStride) continue;
    const auto turned = wheels.between(begin, sample.time);
    if (turned) check.note({sample.time, rotation_log(turned->rotation), rates.integral(begin, sample.time)});
    begin = sample.time;
    rates.forget_before(sample.time - kStride);
  }
  for (const Acceleration& sample : samples.accelerations) check.check(sample);
  std::vector<MotionWarning> warnings = check.warnings();
  const std::vector<MotionWarning> clocks = clock_warnings(samples, first_frame, last_frame);
  warnings.insert(warnings.end(), clocks.begin(), clocks.end());
  return warnings;
}

}  // namespace byre
