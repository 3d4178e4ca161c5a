#pragma once

#include "byre/calibration.h"
#include "byre/io/recording/static_frames.h"
#include "byre/io/ros/messages.h"

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

// The right camera: of rectified images by its P; of raw ones by R and P if P has a baseline, else by the transform
// tree. Throws InputError if neither determines its pose.
StereoPartner partner_of(const CameraInfoWithSource& left, const CameraInfoWithSource& right,
                         const StaticFrames& frames);

// Pose of the camera in the robot's body, the frame base_link. Identity if the tree does not connect them.
Pose body_from_camera(const std::string& camera_frame, const StaticFrames& frames);

}  // namespace byre
