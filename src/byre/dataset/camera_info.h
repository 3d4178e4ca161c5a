#pragma once

#include "byre/calibration.h"
#include "byre/dataset/static_frames.h"
#include "byre/ros/messages.h"

#include <string>

namespace byre {

// Camera info as a driver of ROS tells it (REP-104), and how errors name it.
struct PlacedCameraInfo {
  ros::CameraInfo info;
  std::string place;          // "walk.bag: /left/camera_info", or the topic
  bool is_rectified = false;  // the images that it goes with are
};

// The camera of the images: raw ones by D and K, rectified ones by P. Throws InputError for a camera that is not
// calibrated, of a model that byre does not know, or told in numbers that make no sense, and for binned or cut images.
Camera camera_of(const PlacedCameraInfo& placed);

// The right camera: of rectified images by its P. Of raw ones by R and P where P holds a baseline, and else by the
// frames' tree. Throws InputError when neither tells where it is.
StereoPartner partner_of(const PlacedCameraInfo& left, const PlacedCameraInfo& right, const StaticFrames& frames);

// The camera in the robot's body: the frame base_link, where the tree leads there, else the camera itself.
Pose body_from_camera(const std::string& camera_frame, const StaticFrames& frames);

}  // namespace byre
