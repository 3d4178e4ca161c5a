#pragma once

#include "byre/node/node_config.h"
#include "byre/slam.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace byre {

// The Slam of a node: made once the calibration is known, and anew where another map is loaded or the robot is to be
// looked for from nothing.
class SlamRunner {
 public:
  // Throws InputError for options that cannot be read, and for a file to save that may not be written
  // (input/output_file.h) or that the node reads.
  explicit SlamRunner(const NodeConfig& config);

  // Throws InputError as Slam does, and for a pair of cameras that knows no metres. Where the kept map cannot be used,
  // and the one before it was kept, that is taken instead; then what there is to say about it, else empty.
  std::string start(const Calibration& calibration);

  bool is_running() const { return slam_.has_value(); }
  // What wheels and a gyroscope told before the next frame. Precondition: is_running().
  void tell_wheels(const StampedPose& odometry_from_base) { slam_->tell_wheels(odometry_from_base); }
  void tell_wheels(const BaseVelocity& velocity) { slam_->tell_wheels(velocity); }
  void tell_gyroscope(const AngularRate& rate) { slam_->tell_gyroscope(rate); }
  void tell_accelerometer(const Acceleration& acceleration) { slam_->tell_accelerometer(acceleration); }
  // The next frame; its pose in the map and the covariance of that are as they are published.
  FrameReport process(const CameraImages& images);

  // A pose of the body, as it is published: on the floor plan where that is wanted.
  Pose published(const Pose& map_from_body) const;
  std::optional<std::string> map_damage() const { return slam_->map_damage(); }  // see Slam
  Trajectory trajectory() const { return slam_->trajectory(); }
  // Points of the map that is made, or of the kept map that a mission is on, as they are published. Of a mission the
  // file is read once more, which takes as long as loading it.
  std::vector<Eigen::Vector3f> points() const;
  // Name of the map that the poses are in: that of its file, without folder and ending.
  std::string map_name() const;
  bool makes_a_map() const { return config_.task != NodeTask::mission; }

  // Each throws InputError for what cannot be done, and leaves everything as it was then.
  // Before the first save of this Slam, keeps the present map as its previous version. Returns a report.
  std::string save();
  std::string load(const std::string& name);  // a map beside the one that is loaded, by its file's name alone
  std::string relocalise();                   // looks for the robot from nothing, in the same map
  std::string pause_mapping(bool is_paused);  // nothing is added to what is mapped meanwhile
  // hint: as poses are published. False where the task has no use for it.
  bool look_near(PoseHint hint);
  bool has_anything_to_save() const { return slam_ && config_.save && had_pose_ && slam_->keyframes() > 0; }

 private:
  Slam make(const std::filesystem::path* map) const;
  SlamOptions options_for(const std::filesystem::path& map) const;
  void replace(Slam slam);
  void require_running() const;

  NodeConfig config_;    // constant after construction
  SlamOptions options_;  // constant after construction
  std::optional<std::filesystem::path> map_;
  std::optional<Calibration> calibration_;
  std::optional<Slam> slam_;
  bool is_map_sound_ = true;  // false after a start on the previous version, because the map could not be loaded
  bool has_saved_ = false;    // whether the file was already saved by slam_
  bool had_pose_ = false;     // whether any frame of slam_ had a pose
};

// What a line of the command topic asks for, done. Throws InputError for what is no command, or cannot be done now.
struct Obeyed {
  std::string answer;
  bool begins_anew = false;  // the robot is looked for from nothing
};
Obeyed obey(SlamRunner& runner, const std::string& line);

}  // namespace byre
