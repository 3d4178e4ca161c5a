#include "byre/slam/calibration/determined_calibration.h"

#include "byre/geometry/calibration_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kPriorSigmas = 2.0;
constexpr int kKnown = kRightRotation;      // parameter that images determine
constexpr int kHardlyKnown = kRightCamera;  // parameter that images hardly determine

RefinedCalibration plausible_part(const CalibrationVector& expected) {
  CalibrationMatrix information = CalibrationMatrix::Identity() / (kPriorSigmas * kPriorSigmas);
  information(kKnown, kKnown) = 100.0;
  const Calibration given = scene_calibration();
  const CalibrationVector prior_sigmas = calibrated_sigmas(kPriorSigmas);
  RefinedCalibration found = determined_calibration(given, information, expected, prior_sigmas);
  reject_implausible(found, expected, given, prior_sigmas);
  return found;
}

TEST(DeterminedCalibration, KeepsObservableParametersOnly) {
  CalibrationVector expected = CalibrationVector::Zero();
  expected[kKnown] = 4.0;
  expected[kHardlyKnown] = 3.0;
  const RefinedCalibration found = plausible_part(expected);
  EXPECT_NEAR(found.change[kKnown], 4.0, 1e-9);
  EXPECT_NEAR(found.change[kHardlyKnown], 0.0, 1e-9);
}

TEST(DeterminedCalibration, IsRejectedForAnImplausibleChange) {
  CalibrationVector expected = CalibrationVector::Zero();
  expected[kKnown] = 11.0;
  EXPECT_TRUE(plausible_part(expected).change.isZero(0.0));
}

// Occurs with KITTI's pairs, which are rectified by another model than the estimated one.
TEST(DeterminedCalibration, IsRejectedForAnImplausibleRemainder) {
  CalibrationVector expected = CalibrationVector::Zero();
  expected[kKnown] = 4.0;
  expected[kHardlyKnown] = -11.0;
  EXPECT_TRUE(plausible_part(expected).change.isZero(0.0));
}

}  // namespace
}  // namespace byre
