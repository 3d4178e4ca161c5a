#include "byre/input_error.h"
#include "byre/io/bag/bag.h"
#include "byre/io/calibration/frame_tree.h"
#include "byre/io/recording/bag_topics.h"
#include "byre/io/recording/static_frames.h"
#include "byre/io/ros/message_bytes.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool is_static_topic(const BagTopic& topic) {
  return topic.name.ends_with("tf_static") && is_transform_topic(topic);
}

// The first readable message of a topic; empty if there is none.
template <ros::Message M>
std::optional<M> first_message(Bag& bag, std::size_t topic, const std::string& place) {
  const BagContent& content = bag.content();
  const std::optional<ros::Encoding> encoding = encoding_of(content.topics[topic]);
  if (!encoding) return std::nullopt;
  for (const BagMessage& each : content.messages) {
    if (each.topic != topic) continue;
    try {
      return ros::read_message<M>(bag.read(each), *encoding, place);
    } catch (const InputError&) {
    }
  }
  return std::nullopt;
}

// Empty if the topic of the left images is ambiguous or has no readable image.
std::string frame_of_images(Bag& bag, const fs::path& path) {
  std::size_t left = 0;
  try {
    left = choose_image_topics(bag.content(), {}, path).left;
  } catch (const InputError&) {
    return "";
  }
  if (holds<ros::CompressedImage>(bag.content().topics[left])) {
    const auto image = first_message<ros::CompressedImage>(bag, left, path.string());
    return image ? frame_without_slash(image->header.frame_id) : "";
  }
  const auto image = first_message<ros::Image>(bag, left, path.string());
  return image ? frame_without_slash(image->header.frame_id) : "";
}

// Empty unless one topic has readable IMU messages.
std::string frame_of_imu(Bag& bag, const std::string& place) {
  std::vector<std::string> frames;
  for (std::size_t topic = 0; topic < bag.content().topics.size(); ++topic) {
    if (!holds<ros::Imu>(bag.content().topics[topic])) continue;
    if (const auto imu = first_message<ros::Imu>(bag, topic, place)) {
      frames.push_back(frame_without_slash(imu->header.frame_id));
    }
  }
  return frames.size() == 1 ? frames.front() : "";
}

RobotFrame robot_frame(const ros::TransformStamped& transform, const std::string& place) {
  constexpr double kRounding = 1e-3;
  const auto& [x, y, z, w] = transform.transform.rotation;
  RobotFrame frame{.parent = frame_without_slash(transform.header.frame_id), .place = place};
  const std::optional<Pose> pose = pose_of_transform(transform.transform);
  if (pose && std::abs(Eigen::Quaterniond(w, x, y, z).norm() - 1.0) < kRounding) {
    frame.parent_from_frame = *pose;
  } else {
    frame.fault = "is no finite translation and unit quaternion";
  }
  return frame;
}

// Adds transforms; a later one of a frame replaces an earlier one.
void take(const ros::TFMessage& message, const std::string& place, FrameTree& tree) {
  constexpr std::size_t kMostFrames = 10000;
  for (const ros::TransformStamped& each : message.transforms) {
    const std::string name = frame_without_slash(each.child_frame_id);
    RobotFrame frame = robot_frame(each, fmt::format("{}: {}", place, name));
    if (name.empty() || frame.parent.empty()) continue;
    if (tree.frames.size() > kMostFrames) throw InputError(place, fmt::format("has more than {} frames", kMostFrames));
    tree.frames.try_emplace(frame.parent);
    tree.frames[name] = std::move(frame);
  }
}

}  // namespace

std::optional<FrameTree> read_bag_frames(const fs::path& path) {
  if (!is_bag(path)) return std::nullopt;
  const std::unique_ptr<Bag> bag = open_bag(path, [](std::string_view type) {
    const BagTopic topic{"", std::string(type), ""};
    return is_transform_topic(topic) || holds<ros::Image>(topic) || holds<ros::CompressedImage>(topic) ||
           holds<ros::Imu>(topic);
  });
  FrameTree tree{.place = path.string() + ": /tf_static"};
  const BagContent& content = bag->content();
  for (const BagMessage& each : content.messages) {
    const BagTopic& topic = content.topics[each.topic];
    if (!is_static_topic(topic) || !encoding_of(topic)) continue;
    take(ros::read_message<ros::TFMessage>(bag->read(each), *encoding_of(topic), tree.place), tree.place, tree);
  }
  if (tree.frames.empty()) {
    throw InputError(path.string(), "has no transforms on /tf_static",
                     "record that topic, or give the extrinsics as YAML or URDF");
  }
  tree.image_frame = frame_of_images(*bag, path);
  tree.imu_frame = frame_of_imu(*bag, path.string());
  return tree;
}

}  // namespace byre
