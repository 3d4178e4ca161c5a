#include "byre/base/text_file.h"
#include "byre/ros2/dds/ros_network.h"
#include "byre/ros2/node/node_config.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Member of a configuration, of its fleet or registry settings or of its frames.
template <typename Value>
auto& member_of(auto& config, Value NodeConfig::*member) {
  return config.*member;
}

template <typename Value>
auto& member_of(auto& config, Value FleetSettings::*member) {
  return config.fleet.*member;
}

template <typename Value>
auto& member_of(auto& config, Value RegistrySettings::*member) {
  return config.registry.*member;
}

template <typename Value>
auto& member_of(auto& config, Value ExtrinsicsFrames::*member) {
  return config.extrinsics_frames.*member;
}

// Type of a setting with this value. Choices by name are text.
template <typename Value>
constexpr SettingType kTypeOf = std::is_same_v<Value, bool>       ? SettingType::boolean
                                : std::is_integral_v<Value>       ? SettingType::integer
                                : std::is_floating_point_v<Value> ? SettingType::number
                                                                  : SettingType::text;
template <>
constexpr SettingType kTypeOf<std::optional<int>> = SettingType::integer;
template <>
constexpr SettingType kTypeOf<std::optional<double>> = SettingType::number;

// show: text of a value; parse: value of a text, empty if invalid.
NodeSetting setting(const char* name, std::string range, auto member, const char* meaning, auto show, auto parse) {
  using Value = std::remove_cvref_t<decltype(member_of(std::declval<NodeConfig&>(), member))>;
  return {name,
          kTypeOf<Value>,
          std::move(range),
          meaning,
          [=](const NodeConfig& config) -> std::string { return show(member_of(config, member)); },
          [=](NodeConfig& config, std::string_view text) {
            const auto value = parse(text);
            if (value) member_of(config, member) = *value;
            return value.has_value();
          }};
}

NodeSetting text_if(const char* name, const char* range, auto member, const char* meaning, auto is_valid) {
  return setting(
      name, range, member, meaning, [](const std::string& value) { return value; },
      [=](std::string_view text) { return is_valid(text) ? std::optional<std::string>(text) : std::nullopt; });
}

NodeSetting text(const char* name, auto member, const char* meaning) {
  return text_if(name, "text", member, meaning, [](std::string_view text) { return !text.empty(); });
}

NodeSetting any_text(const char* name, auto member, const char* meaning) {
  return text_if(name, "text or empty", member, meaning, [](std::string_view) { return true; });
}

bool is_topic(std::string_view text) {
  return !text.empty() && fault_in_name(resolve_name(text, "/")).empty();
}

NodeSetting topic(const char* name, auto member, const char* meaning) {
  return text_if(name, "topic or empty", member, meaning,
                 [](std::string_view text) { return text.empty() || is_topic(text); });
}

NodeSetting file(const char* name, auto member, const char* meaning) {
  using File = std::optional<fs::path>;
  return setting(
      name, std::string(kFileRange), member, meaning,
      [](const File& value) { return value ? value->string() : std::string(); },
      [](std::string_view text) { return std::optional<File>(text.empty() ? File() : File(text)); });
}

// Integers have no fraction.
template <typename Number>
std::optional<Number> parse_within(std::string_view text, double least, double most) {
  const auto number = parse_number(text);
  const bool is_valid = number && *number >= least && *number <= most &&
                        (std::is_floating_point_v<Number> || *number == std::floor(*number));
  return is_valid ? std::optional(static_cast<Number>(*number)) : std::nullopt;
}

template <typename Settings, typename Number>
NodeSetting number(const char* name, std::string range, Number Settings::*member, const char* meaning, double least,
                   double most) {
  return setting(
      name, std::move(range), member, meaning,
      [](Number value) { return fmt::format("{:g}", static_cast<double>(value)); },
      [=](std::string_view text) { return parse_within<Number>(text, least, most); });
}

template <typename Number>
NodeSetting optional_number(const char* name, const char* range, std::optional<Number> NodeConfig::*member,
                            const char* meaning, double least, double most) {
  using Value = std::optional<Number>;
  return setting(
      name, range, member, meaning,
      [](const Value& value) { return value ? fmt::format("{:g}", static_cast<double>(*value)) : std::string(); },
      [=](std::string_view text) {
        const Value value = parse_within<Number>(text, least, most);
        return value || text.empty() ? std::optional<Value>(value) : std::nullopt;
      });
}

NodeSetting seconds(const char* name, double NodeConfig::*member, const char* meaning, double most) {
  return number(name, fmt::format("from 0 to {:g} seconds", most), member, meaning, 0.0, most);
}

template <typename Value>
using Names = std::vector<std::pair<std::string_view, Value>>;

// The first name stands for the empty value if Value is optional.
template <typename Value>
NodeSetting choice(const char* name, Names<Value> names, Value NodeConfig::*member, const char* meaning) {
  std::string range;
  for (const auto& [word, value] : names) range.append(range.empty() ? "" : "|").append(word);
  const auto show = [=](const Value& value) {
    return std::string(std::ranges::find(names, value, &std::pair<std::string_view, Value>::second)->first);
  };
  const auto parse = [=](std::string_view text) -> std::optional<Value> {
    const auto found = std::ranges::find(names, text, &std::pair<std::string_view, Value>::first);
    return found != names.end() ? std::optional<Value>(found->second) : std::nullopt;
  };
  return setting(name, range, member, meaning, show, parse);
}

NodeSetting flag(const char* name, bool NodeConfig::*member, const char* meaning) {
  return choice<bool>(name, {{"true", true}, {"false", false}}, member, meaning);
}

}  // namespace

const std::vector<NodeSetting>& node_settings() {
  static const std::vector<NodeSetting> table = {
      text("node.name", &NodeConfig::name, "name of the node"),
      topic("node.namespace", &NodeConfig::name_space, "namespace of the node"),
      choice<std::optional<bool>>("node.services", {{"auto", std::nullopt}, {"true", true}, {"false", false}},
                                  &NodeConfig::services,
                                  "commands and parameters as services, for programs with rmw_cyclonedds_cpp; auto: "
                                  "depends on RMW_IMPLEMENTATION"),
      choice<NodeTask>("slam.task",
                       {{"mission", NodeTask::mission}, {"extend", NodeTask::extend}, {"map", NodeTask::map}},
                       &NodeConfig::task, "mission on an offline map, extension of a map, or a new map"),
      file("slam.map", &NodeConfig::map, "map to localise in or to extend"),
      file("slam.save", &NodeConfig::save, "file of the map made, written by the command save and at the end"),
      choice<MapUpdates>(
          "slam.update",
          {{"off", MapUpdates::off}, {"propose", MapUpdates::propose}, {"automatic", MapUpdates::automatic}},
          &NodeConfig::update,
          "update of slam.map at the end of a mission and by the command update: none, to another file, or in place"),
      file("slam.options", &NodeConfig::options, "options file, see docs/reference/options.md"),
      file("slam.vocabulary", &NodeConfig::vocabulary, "visual vocabulary, replaces the built-in one"),
      choice<Workers>(
          "slam.workers", {{"live", Workers::live}, {"repeatable", Workers::repeatable}, {"none", Workers::none}},
          &NodeConfig::workers, "mapping results applied when ready, after a fixed number of frames, or at once"),
      file("slam.plan", &NodeConfig::plan, "floor plan: its walls reject poses; published as an occupancy grid"),
      file("slam.tags", &NodeConfig::tags, "AprilTags to map, see docs/how-to/use_apriltags.md"),
      flag("grid.from_map", &NodeConfig::has_grid_of_map,
           "occupancy grid computed from slam.map, published if slam.plan is empty"),
      number("grid.resolution", "0.01 to 1 metres", &NodeConfig::grid_resolution, "edge of a cell", 0.01, 1.0),
      number("grid.footprint", "0 to 5 metres", &NodeConfig::grid_footprint,
             "radius of the robot, whose path is free in the grid", 0.0, 5.0),
      optional_number("grid.body_height", "metres or empty", &NodeConfig::body_height,
                      "height of the body's origin above the floor, for a map without a plan; required if the body is "
                      "a camera; empty: 0",
                      -10.0, 10.0),
      topic("images.left", &NodeConfig::left, "images of the left or only camera"),
      topic("images.right", &NodeConfig::right, "images of the right camera; empty: one camera"),
      topic("images.depth", &NodeConfig::depth,
            "depth images for the only camera, docs/how-to/depth_camera.md; empty: none"),
      flag("images.compressed", &NodeConfig::is_compressed,
           "left and right images are JPEG or PNG in sensor_msgs/CompressedImage"),
      flag("images.depth_compressed", &NodeConfig::is_depth_compressed,
           "depth images are compressedDepth or PNG in sensor_msgs/CompressedImage"),
      flag("images.rectified", &NodeConfig::is_rectified,
           "images are rectified, with the projection matrix P of the camera info"),
      flag("images.reliable", &NodeConfig::is_reliable,
           "reliable subscription: lost images are sent again if the camera driver supports it"),
      seconds("images.pair_tolerance", &NodeConfig::pair_tolerance,
              "maximum time between the stamps of left and right or depth image; 0: equal stamps", 0.5),
      seconds("images.pair_wait", &NodeConfig::pair_wait,
              "maximum time that a left image waits for its right or depth image", 1.0),
      file("calibration.file", &NodeConfig::calibration, "calibration file; empty: camera info"),
      optional_number(
          "calibration.baseline", "metres or empty", &NodeConfig::baseline,
          "baseline of the cameras, replaces that of the calibration; required to confirm one outside 2 mm to 1 m",
          std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max()),
      topic("calibration.left_info", &NodeConfig::left_info, "camera info of the left or only camera"),
      topic("calibration.right_info", &NodeConfig::right_info, "camera info of the right camera"),
      topic("calibration.depth_info", &NodeConfig::depth_info,
            "camera info of the depth camera; empty: depth is registered to the left images"),
      file("extrinsics.file", &NodeConfig::extrinsics_file,
           "poses of camera and IMU on the robot, and scale of its wheels: YAML or URDF, docs/reference/extrinsics.md"),
      any_text("extrinsics.base_frame", &ExtrinsicsFrames::base,
               "frame of the robot in the URDF; empty: by convention"),
      any_text("extrinsics.camera_frame", &ExtrinsicsFrames::camera,
               "optical frame of the left or only camera in the URDF; empty: by convention"),
      any_text("extrinsics.imu_frame", &ExtrinsicsFrames::imu, "frame of the IMU in the URDF; empty: by convention"),
      topic("motion.wheels", &NodeConfig::wheels,
            "wheel odometry: nav_msgs/Odometry of wheels alone, or twists, docs/how-to/use_wheels_and_imu.md; empty: "
            "none"),
      topic("motion.gyroscope", &NodeConfig::gyroscope,
            "gyroscope: sensor_msgs/Imu, docs/how-to/use_wheels_and_imu.md; empty: none"),
      text("frames.map", &NodeConfig::map_frame, "frame of the map"),
      text("frames.odom", &NodeConfig::odom_frame, "frame of odometry"),
      text("frames.base", &NodeConfig::base_frame, "frame of the robot"),
      choice<std::optional<ExtrinsicsSource>>(
          "frames.mounting",
          {{"auto", std::nullopt},
           {"file", ExtrinsicsSource::file},
           {"tf", ExtrinsicsSource::tf},
           {"camera", ExtrinsicsSource::camera}},
          &NodeConfig::extrinsics,
          "pose of the left camera on the robot: from the calibration file, from /tf_static, or identity"),
      flag("frames.in_plan", &NodeConfig::in_plan,
           "map frame equals the frame of the floor plan if the map is registered on one"),
      flag("frames.map_to_odom", &NodeConfig::publishes_map_to_odom,
           "publication of map->odom, unless another node publishes it"),
      flag("frames.odom_to_base", &NodeConfig::publishes_odom_to_base,
           "publication of odom->base, unless another node publishes it; false: always that of another node"),
      flag("frames.cameras", &NodeConfig::publishes_cameras,
           "publication of base->camera on /tf_static, unless frames.mounting is tf"),
      seconds("frames.future", &NodeConfig::future, "offset of the time stamp of map->odom after that of its image",
              2.0),
      topic("topics.odometry", &NodeConfig::odometry, "pose without jumps, and velocity"),
      topic("topics.pose", &NodeConfig::pose, "pose in the map"),
      topic("topics.path", &NodeConfig::path, "trajectory of the run"),
      topic("topics.points", &NodeConfig::points, "points of the map"),
      topic("topics.health", &NodeConfig::health, "health, as JSON"),
      topic("topics.events", &NodeConfig::events, "events, as JSON"),
      topic("topics.command", &NodeConfig::command, "commands, as text"),
      text_if("topics.tf", "topic", &NodeConfig::tf, "transforms, read and published", is_topic),
      text_if("topics.tf_static", "topic", &NodeConfig::tf_static, "fixed transforms, read and published", is_topic),
      topic("topics.grid", &NodeConfig::grid, "occupancy grid of the floor plan or of the map"),
      topic("topics.initial_pose", &NodeConfig::initial_pose, "initial poses set by an operator"),
      flag("topics.in_namespace", &NodeConfig::moves_into_namespace,
           "topics.tf, tf_static, grid and initial_pose begin with node.namespace: /robot1/tf, as Nav2 remaps them for "
           "several robots"),
      text("http.address", &NodeConfig::http_address, "address of /healthz, /metrics and the Foxglove protocol"),
      optional_number("http.port", "1 to 65535 or empty", &NodeConfig::http_port,
                      "port of /healthz, /metrics and Foxglove; empty: none", 1.0, 65535.0),
      any_text("mqtt.host", &FleetSettings::host, "MQTT broker for VDA 5050 messages to a fleet manager; empty: none"),
      number("mqtt.port", "1 to 65535", &FleetSettings::port, "port of the broker", 1.0, 65535.0),
      any_text("mqtt.user", &FleetSettings::user, "user name at the broker; empty: none"),
      file("mqtt.password_file", &FleetSettings::password_file, "file whose first line is the user's password"),
      text("mqtt.interface", &FleetSettings::interface_name, "first part of the topic names"),
      text("mqtt.manufacturer", &FleetSettings::manufacturer, "manufacturer of the robot"),
      any_text("mqtt.serial_number", &FleetSettings::serial_number,
               "serial number of the robot; empty: the node's name"),
      any_text("mqtt.map_description", &FleetSettings::map_description, "human-readable description of the map"),
      number("mqtt.rate", "0.1 to 20", &FleetSettings::rate, "maximum number of messages per second on a topic", 0.1,
             20.0),
      any_text("registry.site", &RegistrySettings::site,
               "site in a registry of maps, to which sessions are sent and whose accepted map is used; empty: none"),
      any_text("registry.database", &RegistrySettings::database,
               "its PostgreSQL database, postgresql://ACCOUNT@HOST/DATABASE; empty: of the environment (PGHOST, ...)"),
      number("registry.interval", "1 to 86400 seconds", &RegistrySettings::interval, "time between contacts", 1.0,
             86400.0),
      number("registry.max_megabytes", "1 to 1000000", &RegistrySettings::max_megabytes,
             "disk space of sessions that wait; no session is stored beyond", 1.0, 1e6),
      flag("process.lock_memory", &NodeConfig::locks_memory, "memory locked against paging"),
      number("process.priority", "0 to 99", &NodeConfig::priority,
             "real-time priority of tracking (SCHED_RR), not of mapping; 0: normal priority", 0.0, 99.0)};
  return table;
}

}  // namespace byre
