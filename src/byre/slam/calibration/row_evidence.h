#pragma once

#include "byre/geometry/calibration_change.h"
#include "byre/rig.h"

#include <vector>

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

// Row difference of a corner matched between both images. There are hundreds of thousands.
struct RowMeasurement {
  float offset = 0.0f;                                             // pixels, right minus left
  float sigma = 1.0f;                                              // pixels
  std::size_t part = 0;                                            // see part_of_image
  Eigen::Matrix<float, 1, kCalibrationParameters> by_calibration;  // pixels per sigma of each parameter
};

// Part of the image that contains a pixel: cells of 8 x 6.
std::size_t part_of_image(const Eigen::Vector2f& pixel, const Rig& rig);

// Updates the calibration estimate by rows. In straight motion the same foreground edges stay in the same part of the
// image, and their row errors are alike, however many they are. If parts differ by more than noise and calibration
// explain, each part counts as one measurement, the mean of its rows, with an additional error estimated from the parts
// (Mandel and Paule 1970). Otherwise rows count individually. Sigmas of rows are scaled by their residuals.
CalibrationEstimate learn_from_rows(const std::vector<RowMeasurement>& rows, const CalibrationEstimate& prior);

}  // namespace byre
