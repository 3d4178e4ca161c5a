#include "byre/slam/loops/odometry_motions.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

Pose ahead(double metres) {
  return {Eigen::Quaterniond::Identity(), {metres, 0.0, 0.0}};
}

BodyMotion motion(double metres, double sigma) {
  return {ahead(metres), sigma * sigma * Matrix6::Identity()};
}

TEST(LengthRatio, WeightsMotionsByTheirCovariance) {
  LengthRatio ratio;
  EXPECT_FALSE(ratio.value());
  ratio.add(motion(1.0, 0.01), ahead(0.5));
  ratio.add(motion(1.0, 0.02), ahead(1.0));
  EXPECT_EQ(ratio.count(), 2);
  EXPECT_NEAR(ratio.value().value(), (4.0 * 0.5 + 1.0) / 5.0, 1e-12);
}

TEST(LengthRatio, IsEmptyForOppositeMotions) {
  LengthRatio ratio;
  ratio.add(motion(1.0, 0.01), ahead(-0.5));
  EXPECT_FALSE(ratio.value());
}

TEST(ScaleMotion, ScalesTranslationAndItsError) {
  const BodyMotion scaled = scale_motion(motion(1.0, 0.1), 3.0);
  EXPECT_NEAR(scaled.last_from_body.translation.x(), 3.0, 1e-12);
  EXPECT_NEAR(scaled.covariance(0, 0), 0.09, 1e-12);
  EXPECT_NEAR(scaled.covariance(5, 5), 0.01, 1e-12);
}

}  // namespace
}  // namespace byre
