#pragma once

#include "byre/rig.h"
#include "byre/slam/calibration_knowledge.h"

#include <vector>

namespace byre {

// A row on which a corner was matched in the right image, against that of the left one. There are hundreds of
// thousands.
struct RowMeasurement {
  float offset = 0.0f;                                             // pixels, right less left
  float sigma = 1.0f;                                              // pixels
  std::size_t part = 0;                                            // the part of the image where it lies
  Eigen::Matrix<float, 1, kCalibrationParameters> by_calibration;  // pixels for a sigma of each parameter
};

// The part of the image in which a pixel lies: cells of 8 x 6.
std::size_t part_of_image(const Eigen::Vector2f& pixel, const Rig& rig);

// What is known of the calibration once rows are looked at too. Where a robot drives straight on, the same edges before
// something farther off show in the same part of the image all along, and their rows err alike, however many they are.
// Where parts differ by more than noise and calibration explain, each counts as one measurement, the mean of its rows,
// with an error of its own as large as the parts tell (Mandel and Paule 1970). Else rows count one by one. Sigmas of
// rows grow by what their residuals say.
CalibrationKnowledge learn_from_rows(const std::vector<RowMeasurement>& rows, const CalibrationKnowledge& prior);

}  // namespace byre
