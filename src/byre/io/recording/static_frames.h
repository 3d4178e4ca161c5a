#pragma once

#include "byre/io/ros/messages.h"
#include "byre/pose.h"

#include <map>
#include <optional>
#include <string>

namespace byre {

// Name of a frame as tf2 compares it: those of ROS 1 began with a slash.
std::string frame_without_slash(const std::string& frame);

// Pose of a transform; empty for an invalid one, as any peer may send.
std::optional<Pose> pose_of_transform(const ros::Transform& transform);

// Tree of fixed transforms from /tf_static.
class StaticFrames {
 public:
  // Adds transforms. Invalid ones are dropped, and frames beyond a thousand.
  void take(const ros::TFMessage& message);

  // Transform from frame b to frame a; empty if no chain of fixed transforms connects them.
  std::optional<Pose> between(const std::string& a, const std::string& b) const;

 private:
  struct Parent {
    std::string name;
    Pose parent_from_child;
  };
  // Ancestors of a frame with the transforms to them, the frame itself included; the topmost has no parent.
  std::map<std::string, Pose> ancestors(const std::string& frame) const;

  std::map<std::string, Parent> parents_;  // key: name of the child
};

}  // namespace byre
