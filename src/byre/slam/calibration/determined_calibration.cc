#include "byre/slam/calibration/determined_calibration.h"

#include "byre/geometry/rectification.h"

#include <Eigen/Eigenvalues>

namespace byre {

CalibrationVector calibrated_sigmas(double factor) {
  return CalibrationVector::Constant(factor);
}

// Pixels of cameras are square, and their lenses centred: a free aspect and free tangential distortion take up errors
// by rolling shutter, together with the focal length.
CalibrationVector nominal_sigmas() {
  CalibrationVector sigmas = CalibrationVector::Constant(150.0);
  for (const int camera : {kLeftCamera, kRightCamera}) {
    sigmas[camera + kAspect] = 10.0;                                     // 0.1 %
    sigmas[camera + kCentreU] = sigmas[camera + kCentreV] = 100.0;       // 15 px
    sigmas.segment<2>(camera + kFirstDistortion + 2).setConstant(10.0);  // 0.001 of p1 and p2
  }
  return sigmas;
}

RefinedCalibration determined_calibration(const Calibration& given, const CalibrationMatrix& information,
                                          const CalibrationVector& expected, const CalibrationVector& prior_sigmas) {
  constexpr double kMinGain = 2.0;  // factor by which images reduce the sigma of the prior
  // Parameters in sigmas of the prior.
  const Eigen::SelfAdjointEigenSolver<CalibrationMatrix> directions(prior_sigmas.asDiagonal() * information *
                                                                    prior_sigmas.asDiagonal());
  CalibrationVector along = directions.eigenvectors().transpose() * expected.cwiseQuotient(prior_sigmas);
  CalibrationVector variances = directions.eigenvalues().cwiseInverse();
  int determined = 0;
  double squared_sigmas = 0.0;  // squared size of the change in sigmas, over all determined directions
  for (int i = 0; i < kCalibrationParameters; ++i) {
    if (directions.eigenvalues()[i] >= kMinGain * kMinGain) {
      ++determined;
      squared_sigmas += along[i] * along[i] * directions.eigenvalues()[i];
    } else {
      along[i] = 0.0;
      variances[i] = 1.0;
    }
  }
  constexpr double kSignificant = 2.0;  // sigmas, root mean square; noise alone gives one
  if (squared_sigmas < kSignificant * kSignificant * determined) along.setZero();
  RefinedCalibration result;
  result.change = prior_sigmas.cwiseProduct(directions.eigenvectors() * along);
  result.sigma_before = prior_sigmas;
  result.sigma_after = prior_sigmas.cwiseProduct((directions.eigenvectors().cwiseAbs2() * variances).cwiseSqrt());
  result.calibration = changed(given, result.change);
  return result;
}

void reject_implausible(RefinedCalibration& refined, const CalibrationVector& expected, const Calibration& given,
                        const CalibrationVector& prior_sigmas) {
  const CalibrationVector largest = refined.change.cwiseAbs().cwiseMax(expected.cwiseAbs());
  const bool is_plausible = (largest.array() <= kImplausibleSigmas * prior_sigmas.array()).all();
  if (is_plausible && can_be_rectified(refined.calibration)) return;
  refined.change.setZero();
  refined.calibration = given;
}

}  // namespace byre
