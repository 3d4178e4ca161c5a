#pragma once

#include "byre/io/ros/messages.h"
#include "byre/pose.h"
#include "byre/trajectory.h"

#include <deque>
#include <map>
#include <optional>
#include <string>

namespace byre {

// Transforms that other nodes publish above the base, with a short history, so that no transform has two publishers.
// Stamps are those of the messages.
class RobotFrames {
 public:
  struct Names {
    std::string map, odom, base;
  };
  explicit RobotFrames(const Names& names);

  // Adds transforms of other nodes. Invalid ones are dropped, and frames beyond a thousand. now: a steady clock.
  void take(const ros::TFMessage& message, Timestamp now);
  void take_static(const ros::TFMessage& message);

  // Whether another node has published a transform to the base, which then may have no second parent.
  bool has_base_owner() const { return links_.contains(names_.base); }
  // Whether another node has published a transform to a frame.
  bool has_parent(const std::string& frame) const;
  // Whether another node published a transform to odom within the last seconds.
  bool has_odom_owner(Timestamp now) const;

  // Interpolated between transforms at most 0.5 s apart, extrapolated by at most 0.1 s; empty beyond, next to a jump of
  // odometry, and if the transforms above the base do not lead to odom.
  std::optional<Pose> odom_from_base(Timestamp stamp) const;

  // Arrival of the last transforms of other nodes that lead from odom to the base, of the oldest one between them;
  // empty if none do. Times are those of take(); static transforms have none.
  std::optional<Timestamp> last_odometry() const;

  // Topmost frame known above the base.
  std::string root_of_base() const;

 private:
  struct Sample {
    Timestamp stamp{};
    Pose parent_from_child;
  };
  struct Link {
    std::string parent;
    bool is_static = false;
    Timestamp arrival{};         // time of the last transform; zero if static
    std::deque<Sample> samples;  // by stamp; one if static
  };
  Link* link(const ros::TransformStamped& transform);
  static void add(const Sample& sample, Link& link);
  static std::optional<Pose> at(const Link& link, Timestamp stamp);

  Names names_;                                // constant after construction
  std::map<std::string, Link> links_;          // key: name of the child
  std::optional<Timestamp> last_odom_parent_;  // arrival of the last transform to odom
};

}  // namespace byre
