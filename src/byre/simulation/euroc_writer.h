#pragma once

#include "byre/body_motion.h"
#include "byre/calibration.h"
#include "byre/image.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <vector>

namespace byre {

// Writes a recording into an EuRoC ASL folder: mav0/cam0 and, of a stereo pair, cam1, with their calibrations and lists
// of images; state_groundtruth_estimate0.
class EurocWriter {
 public:
  // Writes all but the images. times: of the images that will follow; truth: as dense as it is to be written, biases
  // are zero. Throws InputError when a file cannot be written.
  EurocWriter(const Calibration& calibration, const std::vector<Timestamp>& times, const Trajectory& truth,
              const std::filesystem::path& folder);

  // The images of one of the times. Several threads may write different frames at once. Throws InputError when a file
  // cannot be written.
  void write(const ImageFrame& frame) const;

 private:
  std::filesystem::path mav_;  // constant after construction
};

// Writes what wheels and a gyroscope told into the folder of a recording: wheel.txt, and mav0/imu0/data.csv without
// accelerations. Throws InputError when a file cannot be written.
void write_motion(const MotionSamples& motion, const std::filesystem::path& folder);

// Writes a calibration into the folder of a recording, beside the one it has: mav0/cam0/true_sensor.yaml and, of a
// pair, cam1. Throws InputError when a file cannot be written.
void write_true_calibration(const Calibration& calibration, const std::vector<Timestamp>& times,
                            const std::filesystem::path& folder);

}  // namespace byre
