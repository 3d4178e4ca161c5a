#pragma once

#include "byre/pose.h"
#include "byre/ros/messages.h"

#include <map>
#include <optional>
#include <string>

namespace byre {

// The frames of /tf_static: what is fixed to what on the robot.
class StaticFrames {
 public:
  // Transforms that make no sense are left out, and so are frames beyond a thousand.
  void take(const ros::TFMessage& message);

  // Takes points of frame b to frame a; empty where no chain of fixed transforms leads from one to the other.
  std::optional<Pose> between(const std::string& a, const std::string& b) const;

 private:
  struct Parent {
    std::string name;
    Pose parent_from_child;
  };
  // The frames above a frame with the way to them, itself first; the last one has no parent.
  std::map<std::string, Pose> above(const std::string& frame) const;

  std::map<std::string, Parent> parents_;  // by the child's name
};

}  // namespace byre
