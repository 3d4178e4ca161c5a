#include "byre/ros2/node/node_config.h"

#include "byre/io/recording/settings_file.h"
#include "byre/playback/report/report.h"
#include "byre/ros2/dds/ros_network.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Setting whose last part shares the longest prefix with the unknown one.
std::string remedy_for_unknown(std::string_view name) {
  const std::string_view word = name.substr(name.rfind('.') + 1);
  for (const NodeSetting& setting : node_settings()) {
    if (setting.name.substr(setting.name.rfind('.') + 1) == word) return "is " + setting.name + " meant?";
  }
  return "see byre node --print-config";
}

// Constraints between settings; faults are reported at the first line involved.
class Consistency {
 public:
  // place: of settings that were not given.
  Consistency(const std::string& place, const std::vector<GivenSetting>& given, std::vector<InputError>& faults)
      : place_(place), given_(given), faults_(faults) {}

  void require(bool holds, std::string_view setting, std::string_view reason, std::string_view remedy) {
    if (holds) return;
    const auto found =
        std::find_if(given_.rbegin(), given_.rend(), [&](const auto& each) { return each.name == setting; });
    faults_.emplace_back(found == given_.rend() ? place_ : found->place,
                         std::string(setting).append(" ").append(reason), remedy);
  }

 private:
  const std::string& place_;
  const std::vector<GivenSetting>& given_;
  std::vector<InputError>& faults_;
};

void check_fleet(const FleetSettings& fleet, Consistency& consistency) {
  const char* const remedy = "use letters, digits and _ . : -";
  const auto require_sound = [&](const char* name, const std::string& text) {
    const std::string_view fault = fault_in_identity(text);
    consistency.require(fault.empty(), name, fault, remedy);
  };
  require_sound("mqtt.interface", fleet.interface_name);
  require_sound("mqtt.manufacturer", fleet.manufacturer);
  if (!fleet.serial_number.empty()) require_sound("mqtt.serial_number", fleet.serial_number);
  consistency.require(!fleet.password_file || !fleet.user.empty(), "mqtt.password_file",
                      "is set, but mqtt.user is empty", "set mqtt.user, or leave this empty");
}

// Whether a topic is of rectified images by the names of image_proc and of camera drivers: "/left/image_rect_color".
bool names_rectified(std::string_view topic) {
  return topic.starts_with("image_rect") || topic.find("/image_rect") != std::string_view::npos;
}

void check_topics(const NodeConfig& config, Consistency& consistency) {
  const bool uses_distortion = !config.calibration && !config.is_rectified;
  for (const auto& [name, topic] : {std::pair("images.left", config.left), std::pair("images.right", config.right)}) {
    consistency.require(!uses_distortion || !names_rectified(topic), name,
                        "is of rectified images, but images.rectified is false, so their distortion would be removed "
                        "twice",
                        "set images.rectified: true, or the topic of the raw images");
  }
  consistency.require(config.left.empty() || config.topic(config.left) != config.topic(config.right), "images.right",
                      "is the topic of the left images", "set the topic of the right images");
  consistency.require(!config.has_depth() || !config.has_right(), "images.depth",
                      "is set, but so is images.right, and depth is used with one camera",
                      "set images.right: \"\", or leave images.depth empty");
  consistency.require(!config.has_depth() || config.topic(config.left) != config.topic(config.depth), "images.depth",
                      "is the topic of the left images", "set the topic of the depth images");
  consistency.require(config.depth_info.empty() || config.has_depth(), "calibration.depth_info",
                      "is set, but images.depth is empty", "set images.depth, or leave this empty");
  const std::array outputs = {std::pair("topics.odometry", config.odometry), std::pair("topics.pose", config.pose),
                              std::pair("topics.path", config.path),         std::pair("topics.points", config.points),
                              std::pair("topics.health", config.health),     std::pair("topics.events", config.events)};
  for (const auto& [input, read] :
       {std::pair("motion.wheels", config.wheels), std::pair("motion.gyroscope", config.gyroscope),
        std::pair("topics.initial_pose", config.initial_pose), std::pair("topics.command", config.command)}) {
    for (const auto& [output, published] : outputs) {
      consistency.require(read.empty() || config.topic(read) != config.topic(published), input,
                          std::string("is ") + output + ", which this node publishes", "set the topic of another node");
    }
  }
}

void check(const NodeConfig& config, Consistency consistency) {
  const bool is_mission = config.task == NodeTask::mission;
  consistency.require(config.task == NodeTask::map || config.map.has_value(), "slam.map", "is missing",
                      "set the map of the building, or set slam.task to map");
  consistency.require(config.task != NodeTask::map || !config.map, "slam.map", "is not used by the task map",
                      "leave it empty, or set slam.task to extend");
  consistency.require(is_mission || config.save.has_value(), "slam.save", "is missing, so the map would be lost",
                      "give a file");
  consistency.require(config.has_right() || config.has_depth() || config.task != NodeTask::map, "images.right",
                      "is empty, but a map of one camera has no metric scale",
                      "set the topic of the right images or images.depth, or map first with byre map and byre scale");
  consistency.require(!config.left.empty(), "images.left", "is empty", "set the topic of the left images");
  const bool needs_info = !config.calibration;
  consistency.require(!needs_info || !config.left_info.empty(), "calibration.left_info",
                      "is empty, and calibration.file is empty too", "set one of the two");
  consistency.require(!needs_info || !config.has_right() || !config.right_info.empty(), "calibration.right_info",
                      "is empty, and calibration.file is empty too", "set one of the two");
  consistency.require(config.calibration || config.extrinsics != ExtrinsicsSource::file, "frames.mounting",
                      "is file, but calibration.file is empty", "set it to tf, or set calibration.file");
  consistency.require(config.name_space.empty() || config.name_space.starts_with('/'), "node.namespace",
                      "does not begin with a slash", "write it as /barn");
  consistency.require(!config.plan || (config.map && config.in_plan), "slam.plan",
                      "needs a map registered on it, and frames.in_plan", "set both, or leave slam.plan empty");
  const ExtrinsicsFrames& frames = config.extrinsics_frames;
  for (const auto& [name, frame] :
       {std::pair("extrinsics.base_frame", frames.base), std::pair("extrinsics.camera_frame", frames.camera),
        std::pair("extrinsics.imu_frame", frames.imu)}) {
    consistency.require(config.extrinsics_file || frame.empty(), name, "is set, but extrinsics.file is empty",
                        "set extrinsics.file, or leave this empty");
  }
  consistency.require(is_mission || config.update == MapUpdates::off, "slam.update", "needs a mission",
                      "set slam.task to mission, or slam.update to off");
  consistency.require(config.registry.site.empty() || config.update != MapUpdates::off, "registry.site",
                      "is set, but slam.update is off", "set slam.update: automatic, or leave this empty");
  consistency.require(!config.registry.site.empty() || config.registry.database.empty(), "registry.database",
                      "is set, but registry.site is empty", "set registry.site, or leave this empty");
  consistency.require(!is_mission || !config.save || config.save != config.map, "slam.save",
                      "is the offline map, which a mission must not replace", "name another file");
  check_topics(config, consistency);
  check_fleet(config.fleet, consistency);
  consistency.require(fault_in_name("/" + config.name).empty(), "node.name", "is not a valid node name",
                      "use letters, digits and underscores");
}

// YAML scalar. Text with characters beyond those of numbers, paths and topics is quoted with JSON escapes.
std::string yaml_scalar(const std::string& text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./";
  const bool is_plain = !text.empty() && text.find_first_not_of(kPlain) == std::string::npos;
  return is_plain ? text : dump_json(text);
}

}  // namespace

std::string NodeConfig::topic(const std::string& given) const {
  // Relative names resolve within the node, such as "/byre/odometry".
  return given.empty() ? "" : resolve_name(given, full_name());
}

fs::path without_tilde(const fs::path& path) {
  const char* const home = std::getenv("HOME");
  if (home == nullptr || path.empty() || *path.begin() != "~") return path;
  return fs::path(home) / path.lexically_relative("~");
}

std::vector<GivenSetting> settings_of_file(const fs::path& given_path) {
  const fs::path path = without_tilde(given_path);
  std::vector<GivenSetting> given;
  for (const Setting& setting : read_settings(path)) {
    given.push_back(
        {setting.name, setting.text, path.string() + ":" + std::to_string(setting.line), path.parent_path()});
  }
  return given;
}

NodeConfigReading config_of(const std::vector<GivenSetting>& given) {
  NodeConfigReading reading;
  for (const GivenSetting& setting : given) {
    const auto known = std::ranges::find(node_settings(), setting.name, &NodeSetting::name);
    if (known == node_settings().end()) {
      reading.faults.emplace_back(setting.place, "unknown setting " + setting.name, remedy_for_unknown(setting.name));
      continue;
    }
    const bool is_path = known->range == kFileRange && !setting.text.empty();
    const std::string text = is_path ? (setting.folder / without_tilde(setting.text)).string() : setting.text;
    if (known->set(reading.config, text)) continue;
    reading.faults.emplace_back(setting.place, setting.name + " is '" + setting.text + "'", "give " + known->range);
  }
  return reading;
}

void complete(NodeConfigReading& reading, const std::vector<GivenSetting>& given, const std::string& place) {
  NodeConfig& config = reading.config;
  check(config, {place, given, reading.faults});
  const std::string prefix = config.name_space + (config.name_space.ends_with('/') ? "" : "/");
  if (!config.moves_into_namespace || prefix == "/") return;
  for (std::string* const topic : {&config.tf, &config.tf_static, &config.grid, &config.initial_pose}) {
    if (topic->starts_with('/') && !topic->starts_with(prefix)) topic->replace(0, 1, prefix);
  }
}

NodeConfigReading read_node_config(const fs::path& path) {
  const std::vector<GivenSetting> given = settings_of_file(path);
  NodeConfigReading reading = config_of(given);
  reading.config.file = without_tilde(path);
  complete(reading, given, reading.config.file->string());
  return reading;
}

std::string node_config_file(const NodeConfig& config) {
  std::string written;
  std::string group;
  for (const NodeSetting& setting : node_settings()) {
    const std::size_t dot = setting.name.find('.');
    const std::string its_group = setting.name.substr(0, dot);
    if (its_group != group) written += its_group + ":\n";
    group = its_group;
    written += "  " + setting.name.substr(dot + 1) + ": " + yaml_scalar(setting.get(config)) + "  # " +
               setting.meaning + " (" + setting.range + ")\n";
  }
  return written;
}

}  // namespace byre
