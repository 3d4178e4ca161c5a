#pragma once

#include "byre/frame_report.h"
#include "byre/io/ros/messages.h"
#include "byre/pose.h"
#include "byre/trajectory.h"

#include <deque>
#include <map>
#include <optional>
#include <string>

namespace byre {

// Frames of REP-105 from tracking reports: map -> odom -> base. odom never jumps, even if tracking is restarted.
// map -> odom is updated while the verdict is not `untrusted`, held otherwise, and withdrawn once the robot is lost, so
// that controllers in the map frame stop.
class PoseFrames {
 public:
  // Starts a new run: its odometry has a new frame, and its map may be another one.
  void restart();

  // Precondition: map_from_body of the report is in the published map frame.
  void note(const FrameReport& report);
  // As above, where another node owns odom -> base: its pose at the time of the image, empty if not known.
  void note(const FrameReport& report, const std::optional<Pose>& odom_from_base_of_owner);

  const std::optional<Pose>& odom_from_base() const { return odom_from_base_; }  // own odometry; empty while unknown
  bool is_odometry_own() const { return is_odometry_own_; }
  const std::optional<Pose>& map_from_odom() const { return map_from_odom_; }  // empty while unknown or withdrawn
  bool is_held() const { return is_held_; }                                    // whether map_from_odom is outdated

 private:
  void note_odometry(const FrameReport& report);
  void update(const FrameReport& report, const std::optional<Pose>& odom_from_base);

  std::optional<Pose> odom_from_start_ = Pose{};  // empty until the first pose of a run
  Pose last_odom_from_base_;
  std::optional<Pose> odom_from_base_;
  std::optional<Pose> map_from_odom_;
  bool is_odometry_own_ = true;
  bool is_held_ = false;
};

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
