#pragma once

#include "byre/extrinsics_file.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace byre {

// Frame of a robot in the tree of its frames.
struct RobotFrame {
  std::string parent{};  // empty: none
  Pose parent_from_frame{};
  std::string place{};  // place of the transform for InputError
  std::string fault{};  // reason why the transform is unusable; empty: usable
};

// Frames of a robot, from a URDF or /tf_static.
struct FrameTree {
  std::string place{};                         // file
  std::map<std::string, RobotFrame> frames{};  // key: name; with all parents
  std::string image_frame{};                   // frame of the left images; empty: unknown
  std::string imu_frame{};                     // frame of the IMU; empty: unknown
};

// Extrinsics by names or conventions, see read_extrinsics. Throws InputError.
Extrinsics extrinsics_of(const FrameTree& tree, const ExtrinsicsFrames& names);

// Links and joints of a URDF. Throws InputError with the line for other XML, xacro, and invalid links and joints.
// place: name of the file.
FrameTree parse_urdf(const std::string& text, const std::string& place);

// Frames of /tf_static in a bag, with those of images and IMU; empty if the path is no bag. Defined in io/recording,
// and for the shared library, which has no bags, in bag_frames_absent.cc.
std::optional<FrameTree> read_bag_frames(const std::filesystem::path& path);

// Rotation of roll, pitch and yaw about the fixed axes x, y and z of the parent, in this order, as in a URDF; radians.
Eigen::Quaterniond rotation_from_rpy(const Eigen::Vector3d& rpy);

// Throws InputError with this place if the translation of a sensor is too long for a robot.
void require_metres(const Pose& base_from_sensor, const std::string& place);

// Whether the z axis of a sensor is within 30 degrees of straight up or down, as of a camera with the axes of its body.
bool is_z_vertical(const Pose& base_from_sensor);

}  // namespace byre
