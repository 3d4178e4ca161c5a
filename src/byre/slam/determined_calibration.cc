#include "byre/slam/determined_calibration.h"

#include <Eigen/Eigenvalues>

namespace byre {

RefinedCalibration determined_calibration(const Calibration& given, const CalibrationMatrix& information,
                                          const CalibrationVector& expected, double prior_sigmas, double min_gain) {
  const Eigen::SelfAdjointEigenSolver<CalibrationMatrix> directions(information);
  const double prior_information = 1.0 / (prior_sigmas * prior_sigmas);
  CalibrationVector along = directions.eigenvectors().transpose() * expected;
  CalibrationVector variances = directions.eigenvalues().cwiseInverse();
  for (int i = 0; i < kCalibrationParameters; ++i) {
    if (directions.eigenvalues()[i] >= min_gain * min_gain * prior_information) continue;
    along[i] = 0.0;
    variances[i] = 1.0 / prior_information;
  }
  RefinedCalibration result;
  result.change = directions.eigenvectors() * along;
  result.sigma_before.setConstant(prior_sigmas);
  result.sigma_after = (directions.eigenvectors().cwiseAbs2() * variances).cwiseSqrt();
  result.calibration = changed(given, result.change);
  return result;
}

}  // namespace byre
