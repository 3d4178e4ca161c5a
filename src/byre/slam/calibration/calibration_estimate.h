#pragma once

#include "byre/geometry/calibration_change.h"

#include <Eigen/Cholesky>

namespace byre {

// Gaussian estimate of the calibration error, in the parameters' sigmas.
struct CalibrationEstimate {
  CalibrationMatrix information = CalibrationMatrix::Zero();
  CalibrationVector expected = CalibrationVector::Zero();
};

// Normal equations of measurements without a prior; they may leave directions undetermined.
struct CalibrationEquations {
  CalibrationMatrix information = CalibrationMatrix::Zero();
  CalibrationVector right_side = CalibrationVector::Zero();

  void operator/=(double factor) {
    information /= factor;
    right_side /= factor;
  }
};

inline CalibrationEquations difference(const CalibrationEstimate& later, const CalibrationEstimate& earlier) {
  return {later.information - earlier.information,
          later.information * later.expected - earlier.information * earlier.expected};
}

inline CalibrationEstimate joined(const CalibrationEstimate& known, const CalibrationEquations& learned) {
  const CalibrationMatrix information = known.information + learned.information;
  return {information, information.ldlt().solve(known.information * known.expected + learned.right_side)};
}

}  // namespace byre
