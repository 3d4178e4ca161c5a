#pragma once

#include "byre/odometry/gyroscope_calibration.h"
#include "byre/odometry/stationary_detector.h"
#include "byre/odometry/wheel_calibration.h"

#include <map>
#include <optional>
#include <string>

namespace byre {

// Calibration of wheels and gyroscope, kept between drives. The gyroscope's bias is not kept: it changes from day to
// day.
struct OdometryCalibration {
  std::optional<WheelCalibration> wheels;
  std::optional<GyroscopeCalibration> gyroscope;
  double time_offset = 0.0;   // delay of wheel stamps against the camera's, seconds
  std::optional<UpInMap> up;  // in the map

  bool is_empty() const { return !wheels && !gyroscope && !up; }
};

// Writes the calibration to notes of a map, under the keys "wheels", "gyroscope" and "gravity": readable numbers with
// names, which read_odometry_calibration parses. Unknown parts have no note.
void write_odometry_calibration(const OdometryCalibration& calibration, std::map<std::string, std::string>& notes);

// Reads the notes of write_odometry_calibration; ignores notes in another format.
OdometryCalibration read_odometry_calibration(const std::map<std::string, std::string>& notes);

// The calibration for a map whose lengths are multiplied by a factor.
OdometryCalibration scaled(OdometryCalibration calibration, double factor);

// The calibration of another point of the body.
OdometryCalibration moved(OdometryCalibration calibration, const Pose& before_from_after);

// The estimate of an earlier drive as a prior of this one: wider by the usual change from drive to drive, and by errors
// that the motions of a drive have in common.
WheelCalibration as_prior(WheelCalibration earlier);

// Whether an estimate by motions differs from the prior by more than the uncertainty of both.
bool is_contradicted(const WheelCalibration& prior, const WheelCalibration& found);

// Note of a map whose scale only wheels measured, with the key kMetresNote: "sigma_by_wheels SHARE".
inline constexpr const char* kMetresNote = "metres";
std::string metres_note(double sigma);

}  // namespace byre
