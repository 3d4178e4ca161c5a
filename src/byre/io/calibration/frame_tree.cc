#include "byre/io/calibration/frame_tree.h"

#include "byre/geometry/degrees.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace byre {
namespace {

constexpr std::string_view kOptical = "optical";
constexpr const char* kWriteYaml = "write the extrinsics as YAML";

std::string lower_case(std::string text) {
  for (char& letter : text) letter = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  return text;
}

bool contains(const std::string& name, std::string_view part) {
  return lower_case(name).find(part) != std::string::npos;
}

using Words = std::initializer_list<std::string_view>;

std::vector<std::string> frames_with(const FrameTree& tree, Words words) {
  std::vector<std::string> names;
  for (const auto& [name, frame] : tree.frames) {
    if (std::ranges::any_of(words, [&](std::string_view word) { return contains(name, word); })) names.push_back(name);
  }
  return names;
}

std::string listing(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 12;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) list += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kMost) list += fmt::format(" and {} more", names.size() - kMost);
  return list;
}

// Frames whose names have one of the words; all frames if there is none.
std::string candidates(const FrameTree& tree, Words words) {
  const std::vector<std::string> found = frames_with(tree, words);
  return "frames: " + listing(found.empty() ? frames_with(tree, {""}) : found);
}

// Throws InputError unless the tree has the frame, with frames that have one of the words. owner, source: in the
// message.
const std::string& known_frame(const FrameTree& tree, const std::string& name, const char* owner, Words words,
                               const char* source = "") {
  if (tree.frames.contains(name)) return name;
  throw InputError(tree.place, fmt::format("has no frame \"{}\"{}", name, source),
                   fmt::format("name the frame of the {0} (--{0}-frame); {1}", owner, candidates(tree, words)));
}

// A base by convention must not move on a part of the robot.
std::string base_frame(const FrameTree& tree, const std::string& named) {
  if (!named.empty()) return known_frame(tree, named, "base", {"base"});
  for (const char* const usual : {"base_link", "base_footprint"}) {
    const auto found = tree.frames.find(usual);
    if (found == tree.frames.end()) continue;
    const RobotFrame& base = found->second;
    if (base.fault.empty()) return usual;
    throw InputError(base.place, fmt::format("{}, above the base \"{}\"", base.fault, usual),
                     "name the frame of the base (--base-frame)");
  }
  throw InputError(tree.place, "has neither base_link nor base_footprint",
                   "name the frame of the base (--base-frame); " + candidates(tree, {"base"}));
}

std::string camera_frame(const FrameTree& tree, const std::string& named) {
  if (!named.empty()) return known_frame(tree, named, "camera", {"cam", kOptical});
  if (!tree.image_frame.empty()) {
    return known_frame(tree, tree.image_frame, "left camera", {"cam", kOptical}, ", which the left images name");
  }
  std::vector<std::string> optical = frames_with(tree, {kOptical});
  std::erase_if(optical, [](const std::string& name) { return !lower_case(name).ends_with("optical_frame"); });
  if (optical.size() == 1) return optical.front();
  std::vector<std::string> left = optical;
  std::erase_if(left, [](const std::string& name) { return !contains(name, "left"); });
  if (left.size() == 1) return left.front();
  constexpr const char* kNameIt = "name the optical frame of the left or only camera; ";
  if (!optical.empty()) {
    throw InputError(tree.place, fmt::format("has {} optical frames", optical.size()),
                     kNameIt + ("one of " + listing(optical)));
  }
  throw InputError(tree.place, "has no frame whose name ends in optical_frame",
                   kNameIt + candidates(tree, {"cam", kOptical}));
}

// Empty if there is none, or if several may be.
std::string imu_frame(const FrameTree& tree, const std::string& named) {
  if (!named.empty()) return known_frame(tree, named, "IMU", {"imu"});
  if (!tree.imu_frame.empty()) return tree.frames.contains(tree.imu_frame) ? tree.imu_frame : "";
  if (tree.frames.contains("imu_link")) return "imu_link";
  const std::vector<std::string> found = frames_with(tree, {"imu"});
  return found.size() == 1 ? found.front() : "";
}

// Throws InputError for a frame that is above itself.
void require_no_cycle(const FrameTree& tree) {
  std::set<std::string> ended;  // frames whose chain of parents ends
  for (const auto& [name, frame] : tree.frames) {
    std::set<std::string> chain;
    std::string at = name;
    while (!at.empty() && !ended.contains(at)) {
      if (!chain.insert(at).second) {
        throw InputError(tree.place, fmt::format("has a cycle of transforms through the frame \"{}\"", at),
                         "correct the parent of one of its frames");
      }
      at = tree.frames.at(at).parent;
    }
    ended.merge(chain);
  }
}

// Names from the frame up to the topmost.
std::vector<std::string> chain_of(const FrameTree& tree, const std::string& frame) {
  std::vector<std::string> chain;
  for (std::string at = frame; !at.empty(); at = tree.frames.at(at).parent) chain.push_back(at);
  return chain;
}

// Pose of the frame in one of its chain. Throws InputError for an unusable transform between them.
Pose pose_in(const FrameTree& tree, const std::string& ancestor, const std::string& frame) {
  Pose ancestor_from_frame;
  for (std::string at = frame; at != ancestor; at = tree.frames.at(at).parent) {
    const RobotFrame& link = tree.frames.at(at);
    if (!link.fault.empty()) {
      throw InputError(link.place, link.fault, fmt::format("name other frames, or {}", kWriteYaml));
    }
    ancestor_from_frame = link.parent_from_frame * ancestor_from_frame;
  }
  return ancestor_from_frame;
}

Pose pose_between(const FrameTree& tree, const std::string& base, const std::string& sensor) {
  const std::vector<std::string> chain = chain_of(tree, base);
  const std::set<std::string> above_base(chain.begin(), chain.end());
  for (const std::string& each : chain_of(tree, sensor)) {
    if (!above_base.contains(each)) continue;
    return inverse(pose_in(tree, each, base)) * pose_in(tree, each, sensor);
  }
  throw InputError(tree.place,
                   fmt::format("does not connect the frame \"{}\" to \"{}\" by fixed transforms", sensor, base),
                   fmt::format("name other frames, or {}", kWriteYaml));
}

SensorMounting mounting_of(const FrameTree& tree, const std::string& base, const std::string& sensor) {
  SensorMounting mounting{.base_from_sensor = pose_between(tree, base, sensor)};
  require_metres(mounting.base_from_sensor, fmt::format("{}: {}", tree.place, sensor));
  return mounting;
}

}  // namespace

Extrinsics extrinsics_of(const FrameTree& tree, const ExtrinsicsFrames& names) {
  require_no_cycle(tree);
  const std::string base = base_frame(tree, names.base);
  const std::string camera = camera_frame(tree, names.camera);
  Extrinsics extrinsics;
  extrinsics.camera = mounting_of(tree, base, camera);
  const std::string name = lower_case(camera);
  const bool is_optical = name.ends_with(kOptical) || name.ends_with("optical_frame");
  if (is_z_vertical(extrinsics.camera->base_from_sensor) && !is_optical) {
    throw InputError(
        fmt::format("{}: {}", tree.place, camera),
        "has a vertical z axis in the base, as a frame with x ahead and z up; that of a camera has z ahead",
        fmt::format("name the optical frame, as camera_optical_frame instead of camera_link, or {} if the "
                    "camera does look up or down",
                    kWriteYaml));
  }
  if (const std::string imu = imu_frame(tree, names.imu); !imu.empty()) extrinsics.imu = mounting_of(tree, base, imu);
  return extrinsics;
}

Eigen::Quaterniond rotation_from_rpy(const Eigen::Vector3d& rpy) {
  return Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX());
}

void require_metres(const Pose& base_from_sensor, const std::string& place) {
  constexpr double kMost = 20.0;  // metres
  const double distance = base_from_sensor.translation.norm();
  if (distance <= kMost) return;
  throw InputError(place, fmt::format("is {:.4g} m from the base, which is too far for a robot", distance),
                   "give metres; are these millimetres?");
}

bool is_z_vertical(const Pose& base_from_sensor) {
  const double least = std::cos(30.0 * kDegree);
  return std::abs((base_from_sensor.rotation * Eigen::Vector3d::UnitZ()).z()) > least;
}

}  // namespace byre
