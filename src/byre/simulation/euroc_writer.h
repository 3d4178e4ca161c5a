#pragma once

#include "byre/body_motion.h"
#include "byre/calibration.h"
#include "byre/image.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <vector>

namespace byre {

// Writes a recording into an EuRoC ASL folder: mav0/cam0, for stereo cam1, with calibrations and image lists;
// state_groundtruth_estimate0.
class EurocWriter {
 public:
  // Writes everything except the images. times: those of all images; truth: written as given, with zero biases. Throws
  // InputError when a file cannot be written.
  EurocWriter(const Calibration& calibration, const std::vector<Timestamp>& times, const Trajectory& truth,
              const std::filesystem::path& folder);

  // Writes the images of one frame. Thread-safe for different frames. Throws InputError when a file cannot be written.
  void write(const ImageFrame& frame) const;

 private:
  std::filesystem::path mav_;
};

// Writes wheel, gyroscope and accelerometer samples into a recording: wheel.txt, and data.csv and sensor.yaml in
// mav0/imu0. Throws InputError when a file cannot be written.
void write_motion(const MotionSamples& motion, const std::filesystem::path& folder);

// Writes the true calibration next to the given one: mav0/cam0/true_sensor.yaml and, for stereo, cam1. Throws
// InputError when a file cannot be written.
void write_true_calibration(const Calibration& calibration, const std::vector<Timestamp>& times,
                            const std::filesystem::path& folder);

}  // namespace byre
