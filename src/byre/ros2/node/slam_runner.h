#pragma once

#include "byre/io/ros/messages.h"
#include "byre/registry/robot_link.h"
#include "byre/ros2/node/map_messages.h"
#include "byre/ros2/node/node_config.h"
#include "byre/slam.h"
#include "byre/slam/system/slam_impl.h"

#include <filesystem>
#include <optional>
#include <string>

namespace byre {

// Path of the previous version of a map: barn.previous.byre for barn.byre.
std::filesystem::path previous_map(const std::filesystem::path& map);

// Copies the map to its previous version before it is replaced. Keeps three: previous, previous_2 and previous_3. Does
// nothing without a map file. Each name refers to a complete map at any time. Throws InputError on failure.
void keep_as_previous(const std::filesystem::path& map);

struct CommandResult {
  std::string answer;
  bool restarts = false;  // starts global relocalisation
  bool loads = false;     // uses another map
};

// The node's Slam. Made once the calibration is available, and again for another map or for global relocalisation.
class SlamRunner {
 public:
  // Throws InputError for unreadable options or extrinsics, and for an output file that may not be written
  // (base/output_file.h) or that the node reads.
  explicit SlamRunner(const NodeConfig& config);

  // Throws InputError as Slam does, and for a stereo pair without metric scale. If the map cannot be used, its previous
  // version is loaded. Returns a note on that, else empty text.
  std::string start(const Calibration& calibration);
  // Before the start: with frames.mounting: tf, the pose of the left camera on the base is also the start of the
  // extrinsics, if the wheels measure the motion of that base. base_of_wheels: frame whose motion they measure; empty
  // without a message. extrinsics.file takes precedence. Returns the choice as text; empty without any extrinsics.
  std::string take_extrinsics(const Pose& base_from_left, const std::optional<std::string>& base_of_wheels);
  const SlamOptions& options() const { return options_; }

  bool is_running() const { return slam_.has_value(); }
  // Motion samples before the next frame. Precondition: is_running().
  void add_wheel_odometry(const StampedPose& odometry_from_base) { slam_->add_wheel_odometry(odometry_from_base); }
  void add_wheel_odometry(const BaseTwist& velocity) { slam_->add_wheel_odometry(velocity); }
  void add_gyro(const AngularRate& rate) { slam_->add_gyro(rate); }
  void add_accel(const Acceleration& acceleration) { slam_->add_accel(acceleration); }
  // Tracks the next frame. Map pose and covariance are in the published frame.
  FrameReport process(const CameraImages& images);

  // Body pose in the published frame: the floor plan's if configured.
  Pose published(const Pose& map_from_body) const;
  std::optional<std::string> map_damage() const { return slam_->map_damage(); }
  Trajectory trajectory() const { return slam_->trajectory(); }
  // Points of the new map, or of a mission's offline map, in the published frame. The offline map is read from its file
  // again, which takes as long as loading.
  std::vector<CloudPoint> points() const;
  // Occupancy grid of the current map, which is read from its file again; in a site that of its plan, if the published
  // frame is that of the plan. Empty without a map or if switched off.
  // Throws InputError if the map has none.
  std::optional<ros::OccupancyGrid> occupancy() const;
  // Name of the active map in its site; without a site its file name without folder and extension.
  std::string map_name() const;
  bool makes_map() const { return config_.task != NodeTask::mission; }

  // Commands throw InputError on failure, without any change. The first save of this Slam keeps the present file as its
  // previous version. All return a report.
  std::string save();
  // Writes what the mission learned beside the map, and updates the map by all such files, see NodeConfig::update. A
  // map updated in place is used from here on; its former version becomes the previous one. With a registry, queues
  // what the mission learned and begins a new session, on the version that the registry accepted if no place is worse.
  CommandResult update();
  std::string load(const std::string& name);  // map in the same folder, by file name
  std::string relocalise();                   // global relocalisation in the same map
  std::string pause_mapping(bool is_paused);  // see Slam::pause_mapping
  // hint: in the published frame. False if the task ignores hints.
  bool set_initial_pose(PoseHint hint);
  bool can_update() const { return slam_ && config_.update != MapUpdates::off && had_pose_ && slam_->keyframes() > 0; }
  const std::string& last_update() const { return last_update_; }  // answer of update(); empty before the first
  std::optional<RobotLinkState> registry() const;                  // empty without a registry
  bool can_save() const { return slam_ && config_.save && had_pose_ && slam_->keyframes() > 0; }

 private:
  Slam make(const std::filesystem::path* map) const;
  const MissionMap* active_map() const;  // nullptr unless a mission
  SlamOptions options_for(const std::filesystem::path& map) const;
  void replace(Slam slam);
  void require_running() const;
  CommandResult update_from_registry();
  std::string use_fetched();

  NodeConfig config_;    // constant after construction
  SlamOptions options_;  // constant once running
  std::optional<std::filesystem::path> map_;
  std::optional<Calibration> calibration_;
  std::optional<Slam> slam_;
  bool is_map_intact_ = true;                     // false after falling back to the previous version of the map
  std::optional<std::filesystem::path> session_;  // file of what slam_ learned, once written
  std::string last_update_;
  std::optional<RobotLink> registry_;
  bool has_saved_ = false;  // whether slam_ has saved the file
  bool had_pose_ = false;   // whether any frame of slam_ had a pose
};

// Executes a line of the command topic. Throws InputError for an unknown command, or one that is impossible now.
CommandResult execute(SlamRunner& runner, const std::string& line);

}  // namespace byre
