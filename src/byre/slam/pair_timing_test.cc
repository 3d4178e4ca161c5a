#include "byre/slam/pair_timing.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

// A hundred points of a frame whose motion in the image differs, or is the same everywhere; values are off by the delay
// times the motion, and by an error of the calibration.
SlopeSum values_with(double delay, bool does_motion_differ) {
  SlopeSum sum;
  sum.begin_frame();
  for (int i = 0; i < 100; ++i) {
    const double place = i % 10 / 10.0 - 0.5;
    const double motion = does_motion_differ ? (i / 10 - 4.5) / 2.0 : 1.0;
    sum.add(motion, {1.0, place, 0.0, 0.0}, delay * motion + 0.3 + 0.7 * place);
  }
  return sum;
}

TEST(SlopeSum, IsTheDelayBesideErrorsOfTheCalibration) {
  for (const double delay : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
    const auto slope = values_with(delay, true).slope(0.3);
    ASSERT_TRUE(slope) << delay;
    EXPECT_NEAR(slope->value, delay, 0.01);
    EXPECT_LT(slope->sigma, 0.1);
  }
}

TEST(SlopeSum, IsEmptyWhereMotionIsNotToldApartFromErrorsOfTheCalibration) {
  EXPECT_FALSE(values_with(1.0, false).slope(0.3));
  EXPECT_FALSE(values_with(1.0, true).slope(3.0)) << "less motion than is asked for";
}

TEST(SlopeSum, IsEmptyWithoutEnoughValues) {
  EXPECT_FALSE(SlopeSum().slope(0.0));
}

}  // namespace
}  // namespace byre
