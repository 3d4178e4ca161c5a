#pragma once

#include "byre/fleet/fleet_link.h"
#include "byre/input_error.h"
#include "byre/slam.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

//   mission  finds itself in a kept map, which stays as it is
//   extend   goes on with a kept map
//   map      makes one
enum class NodeTask : std::uint8_t { mission, extend, map };

// Where the left camera sits on the robot.
//   file    as the calibration file says (T_BS, T_cam_imu): its body is the base frame
//   tf      as /tf_static says, from the base frame to the frame of the left images
//   camera  in the origin of the base frame, which is the camera's own: x right, y down, z forward
enum class Mounting : std::uint8_t { file, tf, camera };

// How a fleet is told where the robot is, docs/integration.md.
struct FleetSettings {
  std::string host;  // broker of MQTT; empty: nobody is told
  int port = 1883;
  std::string user;                                    // empty: none
  std::optional<std::filesystem::path> password_file;  // file with the user's password as its first line
  std::string interface_name = "uagv";
  std::string manufacturer = "byre";
  std::string serial_number;    // empty: the node's name
  std::string map_description;  // may be empty
  double rate = 2.0;            // messages a second
};

// What `byre node` is told. Topics that do not begin with a slash are within the node: "/byre/odometry". An empty one
// is left out. Paths can be opened as they are.
struct NodeConfig {
  std::optional<std::filesystem::path> file;  // file that these settings were read from

  std::string name = "byre";
  std::string name_space = "/";
  std::optional<bool> services;  // whether commands are services too; empty: where ROS is by Cyclone DDS

  NodeTask task = NodeTask::mission;
  std::optional<std::filesystem::path> map;         // map that the robot is on, or that is gone on with
  std::optional<std::filesystem::path> save;        // what was mapped, written when asked and at the end
  std::optional<std::filesystem::path> options;     // docs/options.md
  std::optional<std::filesystem::path> vocabulary;  // empty: the one that comes with byre
  std::optional<std::filesystem::path> plan;        // floor plan to publish
  Workers workers = Workers::live;

  std::string left = "/left/image_raw";
  std::string right = "/right/image_raw";  // empty: one camera
  bool is_compressed = false;              // whether images are JPEG or PNG (sensor_msgs/CompressedImage)
  bool is_rectified = false;               // whether images are rectified, so that camera info's P holds
  bool is_reliable = false;                // whether lost images are sent again, which costs time
  double pair_tolerance = 0.0;             // seconds between left and right image; 0: equal stamps
  double pair_wait = 0.05;                 // seconds that a left image waits for its right one

  std::string wheels;     // odometry by wheels alone; empty: none
  std::string gyroscope;  // empty: none

  std::optional<std::filesystem::path> calibration;  // empty: by camera info
  std::optional<double> baseline;                    // metres; empty: that of the calibration
  std::string left_info = "/left/camera_info";
  std::string right_info = "/right/camera_info";

  std::string map_frame = "map";
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::optional<Mounting> mounting;  // empty: file with a calibration file, else tf
  bool in_plan = true;               // whether the map frame is that of the floor plan that the map is registered on
  bool publishes_map_to_odom = true;
  bool publishes_odom_to_base = true;
  bool publishes_cameras = true;  // whether base->camera is published where /tf_static does not tell it
  double future = 0.1;  // seconds by which map->odom is stamped later than its image, so that nobody waits for it

  std::string odometry = "odometry";
  std::string pose = "pose";
  std::string path = "path";
  std::string points = "points";
  std::string health = "health";
  std::string events = "events";
  std::string command = "command";
  std::string grid = "/map";
  std::string initial_pose = "/initialpose";

  std::string http_address = "127.0.0.1";  // address of this computer that /healthz and /metrics are served at
  std::optional<int> http_port;            // empty: they are not served

  bool locks_memory = false;  // whether memory is kept from being paged out
  int priority = 0;           // real-time priority of tracking; 0: as other programs

  FleetSettings fleet;

  Mounting used_mounting() const { return mounting.value_or(calibration ? Mounting::file : Mounting::tf); }
  bool has_right() const { return !right.empty(); }
  std::string full_name() const { return name_space + (name_space == "/" ? "" : "/") + name; }
  // A topic's whole name; empty where it is left out.
  std::string topic(const std::string& given) const;
};

// One thing that a file of settings may say.
struct NodeSetting {
  std::string name;
  std::string range;
  std::string meaning;  // a noun phrase
  std::function<std::string(const NodeConfig&)> get;
  std::function<bool(NodeConfig&, std::string_view text)> set;  // false for what is no value of it
};

const std::vector<NodeSetting>& node_settings();

// What a YAML file says, and all that is wrong with it: each fault with its line and remedy. Paths in it are taken from
// its folder.
struct NodeConfigReading {
  NodeConfig config;
  std::vector<InputError> faults;
};
NodeConfigReading read_node_config(const std::filesystem::path& path);

// What is wrong with the files that a sound configuration names: each is opened as the node would.
std::vector<InputError> faults_in_files(const NodeConfig& config);

// How the settings have the fleet told; empty: not at all. Throws InputError when the password cannot be read.
std::optional<FleetOptions> fleet_options(const NodeConfig& config);

// The setting that confirms a baseline, up to its value; see with_checked_baseline.
inline constexpr const char* kBaselineSetting = "calibration.baseline: ";

// Throws InputError where the calibration file lacks a camera whose images are named.
void require_cameras(const Calibration& calibration, const NodeConfig& config);

// Throws InputError where a floor plan is named that the kept map does not lie on: it would be published in a wrong
// place.
void require_plan_of_map(const NodeConfig& config);

// All settings as such a file, each with its meaning and range.
std::string node_config_file(const NodeConfig& config);

}  // namespace byre
