#pragma once

#include "byre/calibration.h"
#include "byre/io/recording/static_frames.h"
#include "byre/io/ros/messages.h"

#include <optional>
#include <string>

namespace byre {

// Camera info of a ROS driver (REP-104), and its name in errors.
struct CameraInfoWithSource {
  ros::CameraInfo info;
  std::string place;          // "walk.bag: /left/camera_info", or the topic
  bool is_rectified = false;  // whether its images are rectified
};

// The camera of the images: of raw ones by D and K, of rectified ones by P. Throws InputError for an uncalibrated
// camera, an unsupported model, invalid numbers, and binned or cropped images.
Camera camera_of(const CameraInfoWithSource& placed);

// The right camera: of rectified images by both P; of raw ones by R and P if they have a baseline, else by the
// transform tree. A baseline of positive sign counts as negative, see has_positive_baseline. Throws InputError if
// neither determines its pose.
StereoPartner partner_of(const CameraInfoWithSource& left, const CameraInfoWithSource& right,
                         const StaticFrames& frames);

// Whether P of the right camera alone has a baseline, and of the sign that no right camera has. The images show whether
// the driver errs or the cameras are exchanged.
bool has_positive_baseline(const CameraInfoWithSource& left, const CameraInfoWithSource& right);

// The depth camera by its own camera info. Registered to the left camera if its topic is named so or its frame is that
// of the left camera, and its size too; else with its own lens, placed by the transform tree. Empty if the tree does
// not connect the frames.
std::optional<DepthCamera> depth_camera_of(const CameraInfoWithSource& own, bool is_named_registered,
                                           const Camera& left, const std::string& left_frame,
                                           const StaticFrames& frames);

// Pose of the camera in the robot's body, the frame base_link. Identity if the tree does not connect them.
Pose body_from_camera(const std::string& camera_frame, const StaticFrames& frames);

}  // namespace byre
