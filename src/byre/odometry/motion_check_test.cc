#include "byre/odometry/motion_check.h"

#include "byre/odometry/drive_scene.h"
#include "byre/odometry/recorded_motion.h"
#include "byre/odometry/wheel_track.h"

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kPeriod = 0.02;  // seconds between wheel poses
constexpr double kHuge = 1.0001644e256;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Change = std::function<void(int index, StampedPose& sample)>;

struct Checked {
  WheelTrack track;
  int used = 0;
  int segments = 1;
  std::vector<MotionWarning> warnings;
};

// Checks wheel poses of a drive at half a metre per second, 50 per second, with faults by `change`.
Checked checked_drive(const Change& change, int samples = 500, const MotionLimits& limits = {}) {
  MotionCheck check(limits);
  Checked result;
  for (int i = 0; i < samples; ++i) {
    StampedPose sample{from_seconds(kPeriod * i), Drive::world_from_base(kPeriod * i)};
    change(i, sample);
    const auto [is_clock_set_back, beginning, used] = check.check(sample);
    if (is_clock_set_back) result.track = {};
    if (beginning) {
      result.track.begin_segment(*beginning);
      ++result.segments;
    }
    if (beginning) ++result.used;
    if (used) {
      result.track.add(*used);
      ++result.used;
    }
  }
  result.warnings = check.warnings();
  return result;
}

double translation_error(const WheelTrack& track, double from, double until) {
  const auto way = track.between(from_seconds(from), from_seconds(until));
  const Pose truth = inverse(Drive::world_from_base(from)) * Drive::world_from_base(until);
  return way ? (way->translation - truth.translation).norm() : std::numeric_limits<double>::infinity();
}

TEST(MotionCheck, PassesSoundWheelsUnchanged) {
  const Checked checked = checked_drive([](int, StampedPose&) {});
  EXPECT_EQ(checked.used, 500);
  EXPECT_EQ(checked.segments, 1);
  EXPECT_THAT(checked.warnings, IsEmpty());
  EXPECT_LT(translation_error(checked.track, 1.0, 9.0), 1e-9);
}

TEST(MotionCheck, DropsSingleOutliersOfPoses) {
  for (const double away : {0.5, 50.0, 1e5, kHuge, -kHuge, kNan, std::numeric_limits<double>::infinity()}) {
    const Checked checked = checked_drive([&](int i, StampedPose& sample) {
      if (i > 100 && i % 25 == 1) sample.world_from_body.translation.x() += away;
    });
    EXPECT_EQ(checked.used, 500 - 16) << away;
    EXPECT_EQ(checked.segments, 1) << away;
    EXPECT_THAT(checked.warnings, SizeIs(1)) << away;
    EXPECT_LT(translation_error(checked.track, 1.0, 9.0), 1e-9) << away;
  }
}

TEST(MotionCheck, StartsASegmentAtAJump) {
  for (const int reset : {10, 50, 100, 300, 400}) {
    const Pose origin_from_world = inverse(Drive::world_from_base(kPeriod * reset));
    const Checked checked = checked_drive([&](int i, StampedPose& sample) {
      if (i >= reset) sample.world_from_body = origin_from_world * sample.world_from_body;
    });
    const double at = kPeriod * reset;
    EXPECT_EQ(checked.segments, 2) << reset;
    ASSERT_THAT(checked.warnings, SizeIs(1)) << reset;
    EXPECT_THAT(to_text(checked.warnings.front(), "wheel.txt"), HasSubstr("wheels (wheel.txt), at ")) << reset;
    EXPECT_FALSE(checked.track.between(from_seconds(at - 0.05), from_seconds(at + 0.05))) << reset;
    EXPECT_FALSE(checked.track.between(from_seconds(at - 0.01), from_seconds(at))) << reset;
    EXPECT_TRUE(checked.track.has_jump(from_seconds(at - 0.05), from_seconds(at + 0.05))) << reset;
    EXPECT_LT(translation_error(checked.track, at, at + 1.0), 1e-9) << reset;
    EXPECT_LT(translation_error(checked.track, 0.0, at - kPeriod), 1e-9) << reset;
  }
}

TEST(MotionCheck, DropsPosesOfAStalledDriver) {
  const Checked checked = checked_drive([](int i, StampedPose& sample) {
    if (i >= 200 && i < 350) sample.world_from_body = Drive::world_from_base(kPeriod * 200);
  });
  ASSERT_THAT(checked.warnings, SizeIs(1));
  EXPECT_THAT(checked.warnings.front().what, HasSubstr("stays the same to the last bit"));
  EXPECT_EQ(checked.segments, 2);
  EXPECT_FALSE(checked.track.pose_at(from_seconds(5.0)));
  EXPECT_FALSE(checked.track.between(from_seconds(3.9), from_seconds(7.1)));
  EXPECT_LT(translation_error(checked.track, 7.1, 9.0), 1e-9);
}

TEST(MotionCheck, AcceptsRepeatedPoses) {
  const Checked checked = checked_drive(
      [](int i, StampedPose& sample) { sample.world_from_body = Drive::world_from_base(kPeriod * (i - i % 5)); });
  EXPECT_GT(checked.used, 495);
  EXPECT_LT(translation_error(checked.track, 1.0, 9.0), 1e-9);
}

TEST(MotionCheck, AcceptsPosesOfABaseThatStops) {
  MotionCheck check;
  double speed = 0.8, x = 0.0;
  for (int i = 0; i < 300; ++i) {
    if (i > 100) speed = std::max(0.0, speed - 5.0 * kPeriod);
    x += speed * kPeriod;
    const Pose pose{Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}};
    EXPECT_TRUE(check.check(StampedPose{from_seconds(kPeriod * i), pose}).sample) << i;
  }
  EXPECT_THAT(check.warnings(), IsEmpty());
}

TEST(MotionCheck, RejectsWheelsInAnotherUnit) {
  struct Unit {
    double per_metre;
    const char* name;
  };
  for (const auto& [per_metre, name] : {Unit{100.0, "centimetres"}, Unit{1000.0, "millimetres"}}) {
    const Checked checked =
        checked_drive([&](int, StampedPose& sample) { sample.world_from_body.translation *= per_metre; });
    EXPECT_LT(checked.used, 3);
    ASSERT_THAT(checked.warnings, SizeIs(1));
    EXPECT_THAT(checked.warnings.front().remedy, HasSubstr(name));
  }
  MotionLimits limits;
  limits.max_speed = 100.0;
  const auto in_centimetres = [](int, StampedPose& sample) { sample.world_from_body.translation *= 100.0; };
  EXPECT_EQ(checked_drive(in_centimetres, 500, limits).used, 500) << "the limit is an option";
}

TEST(MotionCheck, DropsPosesWithoutAValidRotation) {
  for (const Eigen::Quaterniond& rotation :
       {Eigen::Quaterniond(0.0, 0.0, 0.0, 0.0), Eigen::Quaterniond(kNan, 0.0, 0.0, 0.0),
        Eigen::Quaterniond(5e-324, 0.0, 0.0, 0.0), Eigen::Quaterniond(kHuge, 0.0, 0.0, 0.0)}) {
    const Checked checked = checked_drive([&](int i, StampedPose& sample) {
      if (i % 2 == 1) sample.world_from_body.rotation = rotation;
    });
    EXPECT_EQ(checked.used, 250);
    EXPECT_THAT(checked.warnings, SizeIs(1));
  }
}

TEST(MotionCheck, DropsStampsFarAhead) {
  const Checked checked = checked_drive([](int i, StampedPose& sample) {
    if (i == 100) sample.time += std::chrono::hours(24);
    if (i == 200) sample.time = Timestamp::max();
    if (i == 300) sample.time = Timestamp::min();
  });
  EXPECT_EQ(checked.used, 497);
  EXPECT_LT(translation_error(checked.track, 1.0, 9.0), 1e-9);
}

TEST(MotionCheck, RestartsAfterTheClockIsSetBack) {
  const Checked checked = checked_drive([](int i, StampedPose& sample) {
    if (i >= 200) sample.time -= std::chrono::hours(1);
  });
  EXPECT_EQ(checked.used, 500 - 9);
  ASSERT_THAT(checked.warnings, SizeIs(1));
  EXPECT_THAT(checked.warnings.front().what, HasSubstr("set back"));
  EXPECT_FALSE(checked.track.pose_at(from_seconds(1.0))) << "earlier samples are discarded";
  EXPECT_TRUE(checked.track.pose_at(from_seconds(-3600.0 + 5.0)));
}

TEST(MotionCheck, DropsImpossibleVelocities) {
  MotionCheck check;
  const auto used = [&](double seconds, double ahead, double turning) {
    return check.check(BaseTwist{from_seconds(seconds), ahead, 0.0, turning}) != StampCheck::Order::dropped;
  };
  EXPECT_TRUE(used(0.0, 0.5, 0.1));
  for (const double value : {kNan, kHuge, -kHuge, 20.0}) EXPECT_FALSE(used(0.1, value, 0.0)) << value;
  for (const double value : {kNan, kHuge, -20.0}) EXPECT_FALSE(used(0.1, 0.0, value)) << value;
  EXPECT_TRUE(used(0.1, 0.5, 0.1));
  EXPECT_FALSE(used(0.05, 0.5, 0.1)) << "not later";
}

// Checks rates of a robot that swings to both sides against turns of half a second from images. factor: of the rates.
MotionCheck checked_swing(double factor, const Eigen::Vector3d& bias = Eigen::Vector3d(0.02, -0.01, 0.03),
                          double seconds = 20.0) {
  MotionCheck check;
  Eigen::Vector3d turned = Eigen::Vector3d::Zero(), measured = turned;
  for (int i = 0; 0.01 * i < seconds; ++i) {
    const double rate = 0.3 * std::sin(0.8 * 0.01 * i);
    const Eigen::Vector3d sample = factor * (Eigen::Vector3d(0.0, 0.0, rate) + bias);
    turned.z() += 0.01 * rate;
    if (check.check(AngularRate{from_seconds(0.01 * i), sample}) != StampCheck::Order::dropped)
      measured += 0.01 * sample;
    if (i % 50 != 49) continue;
    check.note({from_seconds(0.01 * i), turned, measured, true});
    turned = measured = Eigen::Vector3d::Zero();
  }
  return check;
}

TEST(MotionCheck, RejectsAGyroscopeInDegrees) {
  EXPECT_THAT(checked_swing(1.0).warnings(), IsEmpty());
  const MotionCheck check = checked_swing(180.0 / std::numbers::pi);
  ASSERT_THAT(check.warnings(), testing::Not(IsEmpty()));
  EXPECT_THAT(check.warnings().back().remedy, HasSubstr("degrees per second"));
  EXPECT_THAT(check.warnings().back().what, HasSubstr("ignored"));
}

TEST(MotionCheck, RejectsZeroRatesDuringATurn) {
  MotionCheck check = checked_swing(0.0);
  ASSERT_THAT(check.warnings(), SizeIs(1));
  EXPECT_THAT(check.warnings().front().what, HasSubstr("all rates are zero"));
  EXPECT_TRUE(check.is_gyroscope_silent());
  MotionCheck constrain_to_standstill;
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(constrain_to_standstill.check(AngularRate{from_seconds(0.01 * i)}), StampCheck::Order::dropped);
    constrain_to_standstill.note({from_seconds(0.01 * i), Eigen::Vector3d(0.001, 0.0, 0.0), {}, true});
  }
  EXPECT_THAT(constrain_to_standstill.warnings(), IsEmpty()) << "a gyroscope with a dead zone";
  EXPECT_EQ(constrain_to_standstill.check(AngularRate{from_seconds(3.0), {0.0, 0.0, 0.1}}), StampCheck::Order::next);
}

TEST(MotionCheck, RejectsEqualRatesDuringATurn) {
  MotionCheck check;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d rate(0.0, 0.0, i < 100 ? 0.001 * i : 0.02);
    check.check(AngularRate{from_seconds(0.01 * i), rate});
    if (i % 50 == 49) check.note({from_seconds(0.01 * i), {0.0, 0.0, 0.1}, Eigen::Vector3d(0.0, 0.0, 0.1), true});
  }
  ASSERT_THAT(check.warnings(), SizeIs(1));
  EXPECT_THAT(check.warnings().front().what, HasSubstr("all rates are equal"));
}

TEST(MotionCheck, ReportsTheUnitOfAccelerations) {
  const auto warning_of = [](double gravity) {
    MotionCheck check;
    for (int i = 0; i < 300; ++i) check.check(Acceleration{from_seconds(0.01 * i), {0.0, 0.05 * gravity, gravity}});
    return check.warnings().empty() ? std::string() : to_text(check.warnings().front());
  };
  EXPECT_EQ(warning_of(9.81), "");
  EXPECT_THAT(warning_of(1.0), HasSubstr("multiples of g"));
  EXPECT_THAT(warning_of(0.1), HasSubstr("including gravity"));
  EXPECT_THAT(warning_of(981.0), HasSubstr("above motion.max_acceleration_m_per_s2"));
}

TEST(MotionCheck, RejectsInvalidBodyMotion) {
  MotionCheck check;
  const Pose step{Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0}};
  const auto is_used = [&](const BodyMotion& motion) { return check.check(motion, {}, 0.1).has_value(); };
  EXPECT_TRUE(is_used(BodyMotion(step)));
  EXPECT_THAT(check.warnings(), IsEmpty());
  BodyMotion motion(step);
  motion.last_from_body.translation.x() = kNan;
  EXPECT_FALSE(is_used(motion));
  motion = BodyMotion(step);
  motion.covariance(4, 4) = kNan;
  EXPECT_FALSE(is_used(motion));
  motion.covariance(4, 4) = -1.0;
  EXPECT_FALSE(is_used(motion));
  motion = BodyMotion(step);
  motion.last_from_body.rotation = Eigen::Quaterniond(0.0, 0.0, 0.0, 0.0);
  EXPECT_FALSE(is_used(motion));
  motion = BodyMotion(step);
  motion.last_from_body.translation.x() = 5.0;
  EXPECT_FALSE(is_used(motion)) << "5 m in 0.1 s";
  EXPECT_THAT(check.warnings(), SizeIs(2)) << "each kind once";
}

// Wheels and gyroscope of a drive of 20 s.
MotionSamples samples_of_drive() {
  MotionSamples samples;
  for (int i = 0; i < 1000; ++i)
    samples.wheels.push_back({from_seconds(kPeriod * i), Drive::world_from_base(kPeriod * i)});
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.01 * i;
    const Eigen::Vector3d turn =
        rotation_log((inverse(Drive::world_from_base(t)) * Drive::world_from_base(t + 0.01)).rotation);
    samples.rates.push_back({from_seconds(t), turn / 0.01});
  }
  return samples;
}

TEST(CheckMotion, DetectsRatesInDegreesByWheels) {
  MotionSamples samples = samples_of_drive();
  EXPECT_THAT(check_motion(samples, {}, from_seconds(20.0)), IsEmpty());
  MotionLimits limits;
  limits.max_turn_rate = 100.0;
  for (AngularRate& sample : samples.rates) sample.rate *= 180.0 / std::numbers::pi;
  const std::vector<MotionWarning> warnings = check_motion(samples, {}, from_seconds(20.0), limits);
  ASSERT_THAT(warnings, SizeIs(1));
  EXPECT_THAT(warnings.front().what, HasSubstr("57 times"));
}

TEST(CheckMotion, ComparesRatesWithWheelsAfterTheClockIsSetBack) {
  MotionSamples samples = samples_of_drive();
  for (StampedPose& sample : samples.wheels) {
    if (sample.time >= from_seconds(2.0)) sample.time -= std::chrono::hours(1);
  }
  for (AngularRate& sample : samples.rates) {
    if (sample.time < from_seconds(2.0)) continue;
    sample.time -= std::chrono::hours(1);
    sample.rate *= 180.0 / std::numbers::pi;
  }
  MotionLimits limits;
  limits.max_turn_rate = 100.0;
  const std::vector<MotionWarning> warnings = check_motion(samples, from_seconds(-3600.0), from_seconds(20.0), limits);
  EXPECT_THAT(warnings, Contains(Field(&MotionWarning::what, HasSubstr("57 times"))));
}

TEST(CheckMotion, DetectsSamplesOfAnotherClock) {
  MotionSamples samples;
  for (int i = 0; i < 100; ++i) samples.wheels.push_back({from_seconds(3600.0 + kPeriod * i), Pose{}});
  const std::vector<MotionWarning> warnings = check_motion(samples, from_seconds(1.0), from_seconds(20.0));
  ASSERT_THAT(warnings, SizeIs(1));
  EXPECT_THAT(warnings.front().remedy, HasSubstr("one clock"));
}

}  // namespace
}  // namespace byre
