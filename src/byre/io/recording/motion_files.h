#pragma once

#include "byre/body_motion.h"
#include "byre/io/recording/bag_motion.h"
#include "byre/io/recording/restored_times.h"
#include "byre/motion_warning.h"
#include "byre/recording.h"

#include <filesystem>
#include <string>
#include <vector>

namespace byre {

// Selects poses or velocities of wheel samples: poses if they change, else velocities. Drivers that fill in only the
// velocity leave the pose constant while the velocity reports motion.
class WheelStream {
 public:
  enum class Kind { open, poses, velocities };

  // Samples in order of time. Samples of a base that begins to move are held back for some centimetres, until the kind
  // is decided.
  void add(const WheelSample& sample);

  Kind kind() const { return kind_; }
  // Samples since the last call that are not held back, in order of time; none has both pose and velocity.
  std::vector<WheelSample> take();

 private:
  bool accumulate_motion(const WheelSample& sample);
  void emit(const WheelSample& sample);
  void decide(Kind kind);

  Kind kind_ = Kind::open;
  std::optional<Pose> first_;
  std::optional<BaseTwist> last_;
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();  // metres ahead and to the left, radians; integrated velocities
  std::vector<WheelSample> pending_;
  std::vector<WheelSample> output_;
};

// Wheel and gyroscope samples recorded with the images of a folder:
//   wheel.txt               poses of the base in the odometry frame, "time_s tx ty tz qx qy qz qw" (TUM)
//   mav0/imu0/data.csv      EuRoC: time in nanoseconds, angular rates in radians per second, and accelerations in m/s^2
//                           if available
//   mav0/imu0/sensor.yaml   EuRoC: rotation of the sensor relative to the body (T_BS)
// Wheels are used if the file exists or the options name one; the gyroscope if the options request it. Throws
// InputError with file and line if a named file is missing or cannot be parsed. body_from_left: from the recording's
// own calibration. images: clock of the left images.
SensorMotion read_motion(const std::filesystem::path& recording, const OpenOptions& options,
                         const Pose& body_from_left = {}, const SensorClock& images = {});

// Poses of a wheel file, with continuous times (restore_times).
Trajectory read_wheel_file(const std::filesystem::path& path, const SensorClock& images,
                           std::vector<std::string>& warnings);

// File or topic that a sensor's samples were read from.
std::string motion_source(const std::filesystem::path& recording, const OpenOptions& options, MotionSensor sensor);

}  // namespace byre
