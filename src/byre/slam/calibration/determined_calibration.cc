#include "byre/slam/calibration/determined_calibration.h"

#include "byre/geometry/rectification.h"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace byre {

RefinedCalibration determined_calibration(const Calibration& given, const CalibrationMatrix& information,
                                          const CalibrationVector& expected, double prior_sigmas) {
  constexpr double kMinGain = 2.0;  // factor by which images reduce the sigma of the prior
  const Eigen::SelfAdjointEigenSolver<CalibrationMatrix> directions(information);
  const double prior_information = 1.0 / (prior_sigmas * prior_sigmas);
  CalibrationVector along = directions.eigenvectors().transpose() * expected;
  CalibrationVector variances = directions.eigenvalues().cwiseInverse();
  int determined = 0;
  double squared_sigmas = 0.0;  // squared size of the change in sigmas, over all determined directions
  for (int i = 0; i < kCalibrationParameters; ++i) {
    if (directions.eigenvalues()[i] >= kMinGain * kMinGain * prior_information) {
      ++determined;
      squared_sigmas += along[i] * along[i] * directions.eigenvalues()[i];
    } else {
      along[i] = 0.0;
      variances[i] = 1.0 / prior_information;
    }
  }
  constexpr double kSignificant = 2.0;  // sigmas, root mean square; noise alone gives one
  if (squared_sigmas < kSignificant * kSignificant * determined) along.setZero();
  RefinedCalibration result;
  result.change = directions.eigenvectors() * along;
  result.sigma_before.setConstant(prior_sigmas);
  result.sigma_after = (directions.eigenvectors().cwiseAbs2() * variances).cwiseSqrt();
  result.calibration = changed(given, result.change);
  return result;
}

void reject_implausible(RefinedCalibration& refined, const CalibrationVector& expected, const Calibration& given,
                        double prior_sigmas) {
  constexpr double kImplausible = 5.0;  // sigmas of the prior
  const double largest = std::max(refined.change.cwiseAbs().maxCoeff(), expected.cwiseAbs().maxCoeff());
  if (largest <= kImplausible * prior_sigmas && can_be_rectified(refined.calibration)) return;
  refined.change.setZero();
  refined.calibration = given;
}

}  // namespace byre
