#include "byre/base/text_file.h"
#include "byre/ros2/dds/ros_names.h"
#include "byre/ros2/node/node_config.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Table = std::vector<NodeSetting>;

template <typename Place>
NodeSetting text(const char* name, Place place, const char* meaning) {
  return {name, "text", meaning, [=](const NodeConfig& config) -> std::string { return place(config); },
          [=](NodeConfig& config, std::string_view value) {
            if (value.empty()) return false;
            place(config) = value;
            return true;
          }};
}

template <typename Place>
NodeSetting any_text(const char* name, Place place, const char* meaning) {
  return {name, "text or empty", meaning, [=](const NodeConfig& config) -> std::string { return place(config); },
          [=](NodeConfig& config, std::string_view value) {
            place(config) = value;
            return true;
          }};
}

template <typename Place>
NodeSetting topic(const char* name, Place place, const char* meaning) {
  return {name, "topic or empty", meaning, [=](const NodeConfig& config) -> std::string { return place(config); },
          [=](NodeConfig& config, std::string_view value) {
            if (!value.empty() && !fault_in_name(resolve_name(value, "/")).empty()) return false;
            place(config) = value;
            return true;
          }};
}

template <typename Place>
NodeSetting file(const char* name, Place place, const char* meaning) {
  return {name, "file or empty", meaning,
          [=](const NodeConfig& config) { return place(config) ? place(config)->string() : std::string(); },
          [=](NodeConfig& config, std::string_view value) {
            place(config) = value.empty() ? std::nullopt : std::optional<fs::path>(value);
            return true;
          }};
}

template <typename Place>
NodeSetting flag(const char* name, Place place, const char* meaning) {
  return {name, "true|false", meaning,
          [=](const NodeConfig& config) -> std::string { return place(config) ? "true" : "false"; },
          [=](NodeConfig& config, std::string_view value) {
            if (value != "true" && value != "false") return false;
            place(config) = value == "true";
            return true;
          }};
}

template <typename Place>
NodeSetting seconds(const char* name, double most, Place place, const char* meaning) {
  return {name, fmt::format("from 0 to {:g} seconds", most), meaning,
          [=](const NodeConfig& config) { return fmt::format("{:g}", place(config)); },
          [=](NodeConfig& config, std::string_view value) {
            const auto number = parse_number(value);
            if (!number || !(*number >= 0.0 && *number <= most)) return false;
            place(config) = *number;
            return true;
          }};
}

template <typename Value>
using Names = std::vector<std::pair<std::string_view, Value>>;

// The first name stands for the empty value if Value is optional.
template <typename Value, typename Place>
NodeSetting choice(const char* name, Names<Value> names, Place place, const char* meaning) {
  std::string range;
  for (const auto& [word, value] : names) range.append(range.empty() ? "" : "|").append(word);
  const auto get = [=](const NodeConfig& config) {
    const auto found = std::ranges::find(names, place(config), &std::pair<std::string_view, Value>::second);
    return std::string(found->first);
  };
  const auto set = [=](NodeConfig& config, std::string_view value) {
    const auto found = std::ranges::find(names, value, &std::pair<std::string_view, Value>::first);
    if (found == names.end()) return false;
    place(config) = found->second;
    return true;
  };
  return {name, range, meaning, get, set};
}

NodeSetting baseline() {
  return {
      "calibration.baseline", "metres or empty",
      "baseline of the cameras, replaces that of the calibration; required to confirm one outside 2 mm to 1 m",
      [](const NodeConfig& config) { return config.baseline ? fmt::format("{:g}", *config.baseline) : std::string(); },
      [](NodeConfig& config, std::string_view value) {
        config.baseline = parse_number(value);
        return value.empty() || (config.baseline && *config.baseline > 0.0);
      }};
}

void add_slam(Table& table) {
  table.push_back(text(
      "node.name", [](auto& c) -> auto& { return c.name; }, "name of the node"));
  table.push_back(topic(
      "node.namespace", [](auto& c) -> auto& { return c.name_space; }, "namespace of the node"));
  table.push_back(choice<std::optional<bool>>(
      "node.services", {{"auto", std::nullopt}, {"true", true}, {"false", false}},
      [](auto& c) -> auto& { return c.services; },
      "commands also as services, for programs with rmw_cyclonedds_cpp; auto: depends on RMW_IMPLEMENTATION"));
  table.push_back(choice<NodeTask>(
      "slam.task", {{"mission", NodeTask::mission}, {"extend", NodeTask::extend}, {"map", NodeTask::map}},
      [](auto& c) -> auto& { return c.task; }, "mission on an offline map, extension of a map, or a new map"));
  table.push_back(file(
      "slam.map", [](auto& c) -> auto& { return c.map; }, "map to localise in or to extend"));
  table.push_back(file(
      "slam.save", [](auto& c) -> auto& { return c.save; },
      "file of the map made, written by the command save and at the end"));
  table.push_back(file(
      "slam.options", [](auto& c) -> auto& { return c.options; }, "options file, see docs/reference/options.md"));
  table.push_back(file(
      "slam.vocabulary", [](auto& c) -> auto& { return c.vocabulary; },
      "visual vocabulary, replaces the built-in one"));
  table.push_back(choice<Workers>(
      "slam.workers", {{"live", Workers::live}, {"repeatable", Workers::repeatable}, {"none", Workers::none}},
      [](auto& c) -> auto& { return c.workers; },
      "mapping results applied when ready, after a fixed number of frames, or at once"));
  table.push_back(file(
      "slam.plan", [](auto& c) -> auto& { return c.plan; }, "floor plan published as an occupancy grid"));
}

void add_images(Table& table) {
  table.push_back(topic(
      "images.left", [](auto& c) -> auto& { return c.left; }, "images of the left or only camera"));
  table.push_back(topic(
      "images.right", [](auto& c) -> auto& { return c.right; }, "images of the right camera; empty: one camera"));
  table.push_back(flag(
      "images.compressed", [](auto& c) -> auto& { return c.is_compressed; },
      "images are JPEG or PNG in sensor_msgs/CompressedImage"));
  table.push_back(flag(
      "images.rectified", [](auto& c) -> auto& { return c.is_rectified; },
      "images are rectified, with the projection matrix P of the camera info"));
  table.push_back(flag(
      "images.reliable", [](auto& c) -> auto& { return c.is_reliable; },
      "reliable subscription: lost images are sent again if the camera driver supports it"));
  table.push_back(seconds(
      "images.pair_tolerance", 0.5, [](auto& c) -> auto& { return c.pair_tolerance; },
      "maximum time between the stamps of left and right image; 0: equal stamps"));
  table.push_back(seconds(
      "images.pair_wait", 1.0, [](auto& c) -> auto& { return c.pair_wait; },
      "maximum time that a left image waits for its right image"));
  table.push_back(file(
      "calibration.file", [](auto& c) -> auto& { return c.calibration; }, "calibration file; empty: camera info"));
  table.push_back(baseline());
  table.push_back(topic(
      "calibration.left_info", [](auto& c) -> auto& { return c.left_info; }, "camera info of the left or only camera"));
  table.push_back(topic(
      "calibration.right_info", [](auto& c) -> auto& { return c.right_info; }, "camera info of the right camera"));
}

void add_frames(Table& table) {
  table.push_back(text(
      "frames.map", [](auto& c) -> auto& { return c.map_frame; }, "frame of the map"));
  table.push_back(text(
      "frames.odom", [](auto& c) -> auto& { return c.odom_frame; }, "frame of odometry"));
  table.push_back(text(
      "frames.base", [](auto& c) -> auto& { return c.base_frame; }, "frame of the robot"));
  table.push_back(choice<std::optional<ExtrinsicsSource>>(
      "frames.mounting",
      {{"auto", std::nullopt},
       {"file", ExtrinsicsSource::file},
       {"tf", ExtrinsicsSource::tf},
       {"camera", ExtrinsicsSource::camera}},
      [](auto& c) -> auto& { return c.extrinsics; },
      "pose of the left camera on the robot: from the calibration file, from /tf_static, or identity"));
  table.push_back(flag(
      "frames.in_plan", [](auto& c) -> auto& { return c.in_plan; },
      "map frame equals the frame of the floor plan if the map is registered on one"));
  table.push_back(flag(
      "frames.map_to_odom", [](auto& c) -> auto& { return c.publishes_map_to_odom; },
      "publication of map->odom on /tf"));
  table.push_back(flag(
      "frames.odom_to_base", [](auto& c) -> auto& { return c.publishes_odom_to_base; },
      "publication of odom->base on /tf; false if wheel odometry or a filter publishes it"));
  table.push_back(flag(
      "frames.cameras", [](auto& c) -> auto& { return c.publishes_cameras; },
      "publication of base->camera on /tf_static, unless frames.mounting is tf"));
  table.push_back(seconds(
      "frames.future", 2.0, [](auto& c) -> auto& { return c.future; },
      "offset of the time stamp of map->odom after that of its image"));
}

void add_motion(Table& table) {
  table.push_back(topic(
      "motion.wheels", [](auto& c) -> auto& { return c.wheels; },
      "wheel odometry: nav_msgs/Odometry of wheels alone, or twists, docs/how-to/use_wheels_and_imu.md; empty: none"));
  table.push_back(topic(
      "motion.gyroscope", [](auto& c) -> auto& { return c.gyroscope; },
      "gyroscope: sensor_msgs/Imu, docs/how-to/use_wheels_and_imu.md; empty: none"));
}

void add_topics(Table& table) {
  table.push_back(topic(
      "topics.odometry", [](auto& c) -> auto& { return c.odometry; }, "pose without jumps, and velocity"));
  table.push_back(topic(
      "topics.pose", [](auto& c) -> auto& { return c.pose; }, "pose in the map"));
  table.push_back(topic(
      "topics.path", [](auto& c) -> auto& { return c.path; }, "trajectory of the run"));
  table.push_back(topic(
      "topics.points", [](auto& c) -> auto& { return c.points; }, "points of the map"));
  table.push_back(topic(
      "topics.health", [](auto& c) -> auto& { return c.health; }, "health, as JSON"));
  table.push_back(topic(
      "topics.events", [](auto& c) -> auto& { return c.events; }, "events, as JSON"));
  table.push_back(topic(
      "topics.command", [](auto& c) -> auto& { return c.command; }, "commands, as text"));
  table.push_back(topic(
      "topics.grid", [](auto& c) -> auto& { return c.grid; }, "floor plan"));
  table.push_back(topic(
      "topics.initial_pose", [](auto& c) -> auto& { return c.initial_pose; }, "initial poses set by an operator"));
}

std::optional<int> parse_port(std::string_view value) {
  const auto number = parse_number(value);
  if (!number || !(*number >= 1.0 && *number <= 65535.0 && *number == std::floor(*number))) return std::nullopt;
  return static_cast<int>(*number);
}

void add_http(Table& table) {
  table.push_back(text(
      "http.address", [](auto& c) -> auto& { return c.http_address; },
      "address of /healthz, /metrics and the Foxglove protocol"));
  const auto get = [](const NodeConfig& config) { return config.http_port ? std::to_string(*config.http_port) : ""; };
  const auto set = [](NodeConfig& config, std::string_view value) {
    const std::optional<int> port = parse_port(value);
    if (!port && !value.empty()) return false;
    config.http_port = port;
    return true;
  };
  table.push_back(
      {"http.port", "1 to 65535 or empty", "port of /healthz, /metrics and Foxglove; empty: none", get, set});
}

void add_broker(Table& table) {
  table.push_back(any_text(
      "mqtt.host", [](auto& c) -> auto& { return c.fleet.host; },
      "MQTT broker for VDA 5050 messages to a fleet manager; empty: none"));
  const auto set_port = [](NodeConfig& config, std::string_view value) {
    const std::optional<int> port = parse_port(value);
    if (port) config.fleet.port = *port;
    return port.has_value();
  };
  table.push_back({"mqtt.port", "1 to 65535", "port of the broker",
                   [](const NodeConfig& config) { return std::to_string(config.fleet.port); }, set_port});
  table.push_back(any_text(
      "mqtt.user", [](auto& c) -> auto& { return c.fleet.user; }, "user name at the broker; empty: none"));
  table.push_back(file(
      "mqtt.password_file", [](auto& c) -> auto& { return c.fleet.password_file; },
      "file whose first line is the user's password"));
}

void add_fleet(Table& table) {
  add_broker(table);
  table.push_back(text(
      "mqtt.interface", [](auto& c) -> auto& { return c.fleet.interface_name; }, "first part of the topic names"));
  table.push_back(text(
      "mqtt.manufacturer", [](auto& c) -> auto& { return c.fleet.manufacturer; }, "manufacturer of the robot"));
  table.push_back(any_text(
      "mqtt.serial_number", [](auto& c) -> auto& { return c.fleet.serial_number; },
      "serial number of the robot; empty: the node's name"));
  table.push_back(any_text(
      "mqtt.map_description", [](auto& c) -> auto& { return c.fleet.map_description; },
      "human-readable description of the map"));
  const auto set_rate = [](NodeConfig& config, std::string_view value) {
    const auto number = parse_number(value);
    if (!number || !(*number >= 0.1 && *number <= 20.0)) return false;
    config.fleet.rate = *number;
    return true;
  };
  table.push_back({"mqtt.rate", "0.1 to 20", "maximum number of messages per second on a topic",
                   [](const NodeConfig& config) { return fmt::format("{:g}", config.fleet.rate); }, set_rate});
}

void add_process(Table& table) {
  table.push_back(flag(
      "process.lock_memory", [](auto& c) -> auto& { return c.locks_memory; }, "memory locked against paging"));
  const auto set_priority = [](NodeConfig& config, std::string_view value) {
    const auto number = parse_number(value);
    if (!number || !(*number >= 0.0 && *number <= 99.0 && *number == std::floor(*number))) return false;
    config.priority = static_cast<int>(*number);
    return true;
  };
  table.push_back({"process.priority", "0 to 99",
                   "real-time priority of tracking (SCHED_RR), not of mapping; 0: normal priority",
                   [](const NodeConfig& config) { return std::to_string(config.priority); }, set_priority});
}

Table make_table() {
  Table table;
  add_slam(table);
  add_images(table);
  add_motion(table);
  add_frames(table);
  add_topics(table);
  add_http(table);
  add_fleet(table);
  add_process(table);
  return table;
}

}  // namespace

const std::vector<NodeSetting>& node_settings() {
  static const Table table = make_table();
  return table;
}

}  // namespace byre
