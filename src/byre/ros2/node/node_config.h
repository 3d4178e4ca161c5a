#pragma once

#include "byre/calibration_file.h"
#include "byre/extrinsics_file.h"
#include "byre/input_error.h"
#include "byre/ros2/fleet/fleet_link.h"
#include "byre/slam.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

//   mission  localises on a saved map, which is not modified
//   extend   continues a saved map
//   map      makes a new map
enum class NodeTask : std::uint8_t { mission, extend, map };

// What the command update, and the end of a mission, do with what it learned about slam.map.
enum class MapUpdates : std::uint8_t { off, propose, automatic };

// Source of the left camera's pose on the robot.
//   file    calibration file (T_BS, T_cam_imu); its body is the base frame
//   tf      /tf_static, from the base frame to the frame of the left images
//   camera  identity: the base frame is the camera frame, x right, y down, z forward
enum class ExtrinsicsSource : std::uint8_t { file, tf, camera };

// Interface to a fleet manager, docs/how-to/connect_a_fleet.md.
struct FleetSettings {
  std::string host;  // MQTT broker; empty: disabled
  int port = 1883;
  std::string user;                                    // empty: no login
  std::optional<std::filesystem::path> password_file;  // file with the user's password in its first line
  std::string interface_name = "uagv";
  std::string manufacturer = "byre";
  std::string serial_number;    // empty: the node's name
  std::string map_description;  // may be empty
  double rate = 2.0;            // messages per second
};

// Registry of maps, docs/reference/registry.md.
struct RegistrySettings {
  std::string database;           // as of libpq; empty: of the environment
  std::string site;               // empty: disabled
  double interval = 60.0;         // seconds between contacts
  double max_megabytes = 2000.0;  // sessions that wait
};

// Settings of `byre node`. Topics without a leading slash are relative to the node: "/byre/odometry". An empty topic is
// disabled. Paths can be opened as they are.
struct NodeConfig {
  std::optional<std::filesystem::path> file;  // file of these settings

  std::string name = "byre";
  std::string name_space = "/";
  std::optional<bool> services;  // whether commands are also services; empty: with Cyclone DDS only

  NodeTask task = NodeTask::mission;
  std::optional<std::filesystem::path> map;   // offline map, or map to extend
  std::optional<std::filesystem::path> save;  // file for the new map, saved on request and at the end
  MapUpdates update = MapUpdates::off;
  std::optional<std::filesystem::path> options;     // docs/reference/options.md
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary installed with byre
  std::optional<std::filesystem::path> plan;        // floor plan to publish
  std::optional<std::filesystem::path> tags;        // file of AprilTags
  Workers workers = Workers::live;

  bool has_grid_of_map = true;        // publishes an occupancy grid computed from the map, without a floor plan
  double grid_resolution = 0.05;      // metres
  double grid_footprint = 0.3;        // metres, radius of the robot
  std::optional<double> body_height;  // metres above the floor; empty: zero if the body's z axis points up

  std::string left = "/left/image_raw";
  std::string right = "/right/image_raw";  // empty: one camera
  std::string depth;                       // depth images, of one camera; empty: none
  bool is_depth_compressed = false;        // depth images in sensor_msgs/CompressedImage
  bool is_compressed = false;              // JPEG or PNG images (sensor_msgs/CompressedImage)
  bool is_rectified = false;               // images are rectified, so P of camera info applies
  bool is_reliable = false;                // lost images are resent, at the cost of latency
  double pair_tolerance = 0.0;             // seconds between the stamps of a pair; 0: equal stamps
  double pair_wait = 0.05;                 // seconds that a left image waits for its right or depth image

  std::string wheels;     // wheel odometry, not fused with other sensors; empty: none
  std::string gyroscope;  // empty: none

  std::optional<std::filesystem::path> calibration;  // empty: camera info
  std::optional<double> baseline;                    // metres; empty: that of the calibration
  // Extrinsics of the robot with names of frames in a URDF; empty: from /tf_static, or estimated while driving.
  std::optional<std::filesystem::path> extrinsics_file;
  ExtrinsicsFrames extrinsics_frames;
  std::string left_info = "/left/camera_info";
  std::string right_info = "/right/camera_info";
  std::string depth_info;  // empty: depth is registered to the left camera

  std::string map_frame = "map";
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::optional<ExtrinsicsSource> extrinsics;  // empty: file with a calibration file, else tf
  bool in_plan = true;                         // map frame is that of the floor plan on which the map is registered
  bool publishes_map_to_odom = true;
  bool publishes_odom_to_base = true;  // unless another node does
  bool publishes_cameras = true;       // publishes base->camera if /tf_static does not contain it
  double future = 0.1;                 // seconds added to the stamp of map->odom, so that lookups need not wait

  std::string odometry = "odometry";
  std::string pose = "pose";
  std::string path = "path";
  std::string points = "points";
  std::string health = "health";
  std::string events = "events";
  std::string command = "command";
  std::string tf = "/tf";
  std::string tf_static = "/tf_static";
  std::string grid = "/map";
  std::string initial_pose = "/initialpose";
  bool moves_into_namespace = false;  // moves the four topics above into the namespace, as complete() does

  std::string http_address = "127.0.0.1";  // local address for /healthz and /metrics
  std::optional<int> http_port;            // empty: no HTTP server

  bool locks_memory = false;  // locks memory against paging
  int priority = 0;           // real-time priority of tracking; 0: normal scheduling

  FleetSettings fleet;
  RegistrySettings registry;

  ExtrinsicsSource extrinsics_source() const {
    return extrinsics.value_or(calibration ? ExtrinsicsSource::file : ExtrinsicsSource::tf);
  }
  bool has_right() const { return !right.empty(); }
  bool has_depth() const { return !depth.empty(); }
  // Topic of the images paired with the left ones; empty: none. Right and depth images exclude each other.
  const std::string& second() const { return has_depth() ? depth : right; }
  bool is_second_compressed() const { return has_depth() ? is_depth_compressed : is_compressed; }
  std::string full_name() const { return name_space + (name_space == "/" ? "" : "/") + name; }
  // Full name of a topic: relative names are within the node. Empty if it is disabled.
  std::string topic(const std::string& given) const;
};

// Type of a setting as a parameter of ROS.
enum class SettingType : std::uint8_t { boolean, integer, number, text };

// Setting of a configuration file.
struct NodeSetting {
  std::string name;
  SettingType type = SettingType::text;
  std::string range;
  std::string meaning;  // noun phrase
  std::function<std::string(const NodeConfig&)> get;
  std::function<bool(NodeConfig&, std::string_view text)> set;  // false for an invalid value
};

const std::vector<NodeSetting>& node_settings();

inline constexpr std::string_view kFileRange = "file or empty";  // range of paths

// Contents of a YAML file with all of its faults, each with line and remedy. Relative paths start at its folder, and
// "~" is the home folder.
struct NodeConfigReading {
  NodeConfig config;
  std::vector<InputError> faults;
};
NodeConfigReading read_node_config(const std::filesystem::path& path);

// Path with the home folder in place of a leading ~, which only shells expand.
std::filesystem::path without_tilde(const std::filesystem::path& path);

// Setting of a configuration before it is parsed.
struct GivenSetting {
  std::string name;
  std::string text;
  std::string place;             // for messages
  std::filesystem::path folder;  // folder of relative paths
};
std::vector<GivenSetting> settings_of_file(const std::filesystem::path& path);

// Configuration with these settings, later ones replacing earlier ones, and the faults of each.
NodeConfigReading config_of(const std::vector<GivenSetting>& given);

// Completes a configuration of the settings given: checks them against each other, and moves topics into the namespace
// if so configured. place: for faults of settings that were not given.
void complete(NodeConfigReading& reading, const std::vector<GivenSetting>& given, const std::string& place);

// Faults of the files named in a valid configuration; opens each as the node would. notes: assumptions about them.
std::vector<InputError> faults_in_files(const NodeConfig& config, std::vector<std::string>& notes);

// Fleet interface of the settings; empty: disabled. Throws InputError if the password cannot be read.
std::optional<FleetOptions> fleet_options(const NodeConfig& config);

// Setting that confirms an implausible baseline, without its value; see with_checked_baseline.
inline constexpr const char* kBaselineSetting = "calibration.baseline: ";

// Reads the calibration file, with assumptions about it. Throws InputError also if it lacks a camera whose topic is
// named. Precondition: config.calibration.
CalibrationReading read_node_calibration(const NodeConfig& config);

// Depth camera of the calibration file, if that has any of its fields. Throws InputError for invalid ones.
std::optional<DepthCamera> read_node_depth_camera(const NodeConfig& config);

// Fault of a calibration file without a body frame, as the base frame would then be the optical frame of the left
// camera; empty if it has one, or if the settings choose that.
std::optional<InputError> fault_of_base_frame(const Calibration& calibration, const NodeConfig& config);

// Throws InputError if a floor plan is named on which the map is not registered, as it would be published in a wrong
// place.
void require_plan_of_map(const NodeConfig& config);

// Configuration file with all settings, their meanings and ranges.
std::string node_config_file(const NodeConfig& config);

}  // namespace byre
