#pragma once

#include "byre/extrinsics.h"

#include <filesystem>
#include <string>

namespace byre {

// Names of frames in a URDF or in /tf_static. Empty: found by the conventions of read_extrinsics.
struct ExtrinsicsFrames {
  std::string base{};
  std::string camera{};  // left or only camera; its optical frame
  std::string imu{};
};

// Reads the extrinsics of a robot. The content of the file determines the format:
//   YAML   base_from_camera, base_from_imu, wheels, camera_axes; alone, or among the fields of a calibration file. The
//          frames are not used. See docs/reference/extrinsics.md.
//   URDF   fixed joints between the frames; not xacro
//   bag    /tf_static of ROS 1 or 2; not in the shared library
// Frames by convention:
//   base     base_link, else base_footprint
//   camera   frame of the left images of a bag; else the only one that ends in optical_frame, or among several the only
//            one with "left" in its name
//   imu      frame of the only IMU topic of a bag; else imu_link, else the only one with "imu" in its name; left empty
//            if there is none or several
// Throws InputError with the place for a missing, ambiguous or moving frame, an unknown field, and for a value that is
// no rotation, not finite or likely in the wrong unit or axes.
Extrinsics read_extrinsics(const std::filesystem::path& path, const ExtrinsicsFrames& frames = ExtrinsicsFrames());

// Writes the extrinsics as YAML, which read_extrinsics reads back. Throws InputError for lengths and scales that it
// would reject, and if the file cannot be written.
void write_extrinsics(const std::filesystem::path& path, const Extrinsics& extrinsics);

}  // namespace byre
