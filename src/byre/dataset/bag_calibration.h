#pragma once

#include "byre/calibration.h"
#include "byre/ros/messages.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Frames that do not move with respect to each other, as /tf_static tells of them.
class FrameTree {
 public:
  void add(const ros::TFMessage& message);
  // Empty where no chain leads from one to the other.
  std::optional<Pose> between(const std::string& a, const std::string& b) const;  // a_from_b

 private:
  struct Parent {
    std::string name;
    Pose parent_from_child;
  };
  // The frames above this one, from itself up, each with its pose of this frame.
  std::vector<Parent> chain(const std::string& frame) const;

  std::map<std::string, Parent> parents_;
};

// Camera info as a bag has it, and how errors name it.
struct PlacedCameraInfo {
  ros::CameraInfo info;
  std::string place;          // "walk.bag: /left/camera_info"
  bool is_rectified = false;  // the images that it goes with are
};

// The camera of the images: raw ones by D and K, rectified ones by P. Throws InputError for a camera that is not
// calibrated or of a model that byre does not know, and for binned or cut images.
Camera camera_of(const PlacedCameraInfo& placed);

// The right camera: of rectified images by its P. Of raw ones by R and P where P holds a baseline, and else by the
// frames' tree. Throws InputError when neither tells where it is.
StereoPartner partner_of(const PlacedCameraInfo& left, const PlacedCameraInfo& right, const FrameTree& frames);

// The camera in the robot's body: the frame base_link, where the tree leads there, else the camera itself.
Pose body_from_camera(const std::string& camera_frame, const FrameTree& frames);

}  // namespace byre
