#include "byre/slam/mapping/calibrator.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

class RefinedCalibrator : public ::testing::Test {
 protected:
  static Calibration given() {
    Calibration calibration;
    calibration.left = {CameraModel::pinhole, 640, 480, 400.0, 400.0, 320.0, 240.0, {}};
    return calibration;
  }
  // State after a refinement with that many keyframes.
  void refine(int keyframes) {
    calibrator_.note_attempt(keyframes);
    RefinedCalibration refined;
    refined.calibration = given();
    calibrator_.apply_update(refined, {given(), given()});
  }

  Calibrator calibrator_{given(), {}};
};

TEST_F(RefinedCalibrator, IsPendingUntilTheFirstEstimate) {
  calibrator_.note_images(false);
  EXPECT_TRUE(calibrator_.is_open());
  refine(7);
  EXPECT_FALSE(calibrator_.is_open());
}

// Observed in a rendered room with a focal length 20 % too long: usual changes explain 7 and 10 keyframes, but not 13.
TEST_F(RefinedCalibrator, IsPendingLongerIfImagesContradictedTheGivenCalibration) {
  calibrator_.note_images(true);
  refine(7);
  calibrator_.note_images(false);
  EXPECT_TRUE(calibrator_.is_open()) << "despite the fit of the refined calibration";
  refine(25);
  EXPECT_TRUE(calibrator_.is_open());
  refine(28);
  EXPECT_FALSE(calibrator_.is_open());
}

TEST_F(RefinedCalibrator, IsRefinedAtTheEndAfterAnAttemptWithoutResult) {
  refine(16);
  calibrator_.note_attempt(22);
  EXPECT_TRUE(calibrator_.is_final_run_useful(23)) << "the result is that of 16 keyframes";
  refine(22);
  EXPECT_FALSE(calibrator_.is_final_run_useful(23));
  EXPECT_TRUE(calibrator_.is_final_run_useful(28));
}

}  // namespace
}  // namespace byre
