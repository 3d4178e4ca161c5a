#include "byre/io/recording/bag_topics.h"

#include "byre/input_error.h"
#include "byre/io/ros/messages.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Numbers = std::vector<std::size_t>;

constexpr std::string_view kCompressed = "/compressed";

constexpr std::string_view kCompressedDepth = "/compressedDepth";

std::string without_compressed(const std::string& name) {
  for (const std::string_view ending : {kCompressed, kCompressedDepth}) {
    if (name.ends_with(ending)) return name.substr(0, name.size() - ending.size());
  }
  return name;
}

std::string parent_of(const std::string& name) {
  const std::string raw = without_compressed(name);
  return raw.substr(0, raw.rfind('/') == std::string::npos ? 0 : raw.rfind('/'));
}

// Name of the camera of a topic: its parent, or the topic itself at the top level, unless it has a common name.
std::string camera_name(const std::string& topic) {
  const std::string parent = parent_of(topic);
  const std::string raw = without_compressed(topic);
  return parent.empty() && !raw.starts_with("/image") && !raw.starts_with("image") ? raw : parent;
}

// Processing stage of the images: raw, grey, colour, rectified. Compressed ones follow raw ones of the same stage.
int processing(const BagTopic& topic) {
  const std::string raw = without_compressed(topic.name);
  const std::string kind = raw.substr(raw.rfind('/') + 1);
  int steps = 0;
  if (kind.find("mono") != std::string::npos) steps = 1;
  if (kind.find("color") != std::string::npos) steps = 2;
  if (kind.find("rect") != std::string::npos) steps += 4;
  return 2 * steps + (holds<ros::CompressedImage>(topic) ? 1 : 0);
}

bool is_supported_image(const BagTopic& topic) {
  return (holds<ros::Image>(topic) || holds<ros::CompressedImage>(topic)) && topic.messages > 0 && encoding_of(topic);
}

bool names_depth(const std::string& name) {
  return name.find("depth") != std::string::npos || name.find("Depth") != std::string::npos;
}

// Length of the common start of two names, up to their last common separator.
std::size_t common_start(const std::string& a, const std::string& b) {
  std::size_t common = 0;
  for (std::size_t i = 0; i < a.size() && i < b.size() && a[i] == b[i]; ++i) {
    if (a[i] == '/') common = i;
  }
  return common;
}

// A type of video packets or of another format of images that is not read; empty for other types.
std::string_view unread_kind(const BagTopic& topic) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kKinds = {
      {{"CompressedVideo", "video (H.264 or H.265)"},
       {"FFMPEGPacket", "video (H.264 or H.265)"},
       {"H264Packet", "video (H.264)"},
       {"H265Packet", "video (H.265)"},
       {"theora_image_transport", "video (Theora)"},
       {"Theora", "video (Theora)"}}};
  for (const auto& [type, kind] : kKinds) {
    if (topic.type.find(type) != std::string::npos) return kind;
  }
  return {};
}

// Possible names of the right camera's topic for a left one.
std::set<std::string> names_of_right(const std::string& left) {
  using Words = std::pair<std::string_view, std::string_view>;
  constexpr std::array kWords = {Words{"left", "right"},        Words{"Left", "Right"},    Words{"LEFT", "RIGHT"},
                                 Words{"cam0", "cam1"},         Words{"cam_0", "cam_1"},   Words{"camera0", "camera1"},
                                 Words{"camera_0", "camera_1"}, Words{"infra1", "infra2"}, Words{"image_0", "image_1"},
                                 Words{"fisheye1", "fisheye2"}};
  std::set<std::string> names;
  for (const auto& [from, to] : kWords) {
    std::string all = left;
    for (std::size_t at = all.find(from); at != std::string::npos; at = all.find(from, at + to.size())) {
      all.replace(at, from.size(), to);
    }
    for (std::size_t at = left.find(from); at != std::string::npos; at = left.find(from, at + 1)) {
      names.insert(std::string(left).replace(at, from.size(), to));
    }
    if (all != left) names.insert(all);
  }
  return names;
}

std::string listing(const BagContent& content) {
  std::string text;
  for (const BagTopic& topic : content.topics) {
    if (!is_image_topic(topic)) continue;
    text += (text.empty() ? "" : ", ") + topic.name + " (" + std::to_string(topic.messages) + ")";
  }
  return text.empty() ? "none" : text;
}

// Throws InputError if the bag has videos, which are not read.
void refuse_videos(const BagContent& content, const fs::path& bag) {
  for (const BagTopic& topic : content.topics) {
    if (unread_kind(topic).empty()) continue;
    throw InputError(bag.string(),
                     "has images as " + std::string(unread_kind(topic)) + " on topic " + topic.name + " (" +
                         topic.type + "), which is not read",
                     "republish it as sensor_msgs/msg/Image or CompressedImage and record that, or extract the images");
  }
}

[[noreturn]] void fail(const fs::path& bag, const std::string& reason, const BagContent& content) {
  throw InputError(bag.string(), reason + "; available image topics: " + listing(content),
                   "select topics with --left TOPIC and --right TOPIC, or with --left TOPIC alone");
}

class Chooser {
 public:
  Chooser(const BagContent& content, const fs::path& bag) : content_(content), bag_(bag) {
    for (std::size_t i = 0; i < content.topics.size(); ++i) {
      if (is_image_topic(content.topics[i])) images_.push_back(i);
    }
  }

  std::size_t named(const std::string& name) const {
    for (const std::size_t i : images_) {
      if (this->name(i) == name || this->name(i) == "/" + name) return i;
    }
    fail(bag_, "has no images on topic " + name, content_);
  }

  std::optional<std::size_t> right_of(std::size_t left) const {
    const std::set<std::string> names = names_of_right(name(left));
    for (const std::size_t i : images_) {
      if (names.contains(name(i))) return i;
    }
    return std::nullopt;
  }

  std::optional<std::size_t> depth_named(const std::string& name) const {
    for (std::size_t i = 0; i < content_.topics.size(); ++i) {
      const BagTopic& topic = content_.topics[i];
      if (is_supported_image(topic) && (topic.name == name || topic.name == "/" + name)) return i;
    }
    fail(bag_, "has no depth images on topic " + name, content_);
  }

  std::optional<std::size_t> depth_of(std::size_t left) const {
    std::optional<std::size_t> best;
    const auto rank = [&](std::size_t i) {
      const BagTopic& topic = content_.topics[i];
      return std::tuple(common_start(topic.name, name(left)), is_registered(topic), holds<ros::Image>(topic));
    };
    for (std::size_t i = 0; i < content_.topics.size(); ++i) {
      if (is_depth_topic(content_.topics[i]) && (!best || rank(i) > rank(*best))) best = i;
    }
    return best;
  }

  ImageTopics guessed() const {
    std::vector<ImageTopics> pairs;
    for (const std::size_t i : images_) {
      if (const std::optional<std::size_t> right = right_of(i)) pairs.push_back({i, right});
    }
    if (!pairs.empty()) return least_processed(std::move(pairs));
    if (images_.empty()) refuse_videos(content_, bag_);
    if (images_.empty()) fail(bag_, "contains no images of a supported type", content_);
    for (const std::size_t i : images_) pairs.push_back({i});
    return least_processed(std::move(pairs));
  }

 private:
  const std::string& name(std::size_t topic) const { return content_.topics[topic].name; }

  // Precondition: choices are kinds of the images of one camera.
  ImageTopics least_processed(std::vector<ImageTopics> choices) const {
    for (const ImageTopics& choice : choices) {
      if (camera_name(name(choice.left)) != camera_name(name(choices.front().left))) {
        fail(bag_, "contains images of several cameras; the choice is ambiguous", content_);
      }
    }
    return *std::ranges::min_element(choices, {}, [&](const ImageTopics& choice) {
      return std::pair(processing(content_.topics[choice.left]), choice.left);
    });
  }

  const BagContent& content_;
  const fs::path& bag_;
  Numbers images_;
};

}  // namespace

bool is_image_topic(const BagTopic& topic) {
  return is_supported_image(topic) && !names_depth(topic.name);
}

bool is_depth_topic(const BagTopic& topic) {
  return is_supported_image(topic) && names_depth(topic.name);
}

bool is_transform_topic(const BagTopic& topic) {
  return holds<ros::TFMessage>(topic) || topic.type == "tf/tfMessage";
}

bool is_registered(const BagTopic& topic) {
  return topic.name.find("aligned") != std::string::npos || topic.name.find("registered") != std::string::npos;
}

bool is_rectified(const BagTopic& topic) {
  const std::string raw = without_compressed(topic.name);
  return raw.find("rect", raw.rfind('/') == std::string::npos ? 0 : raw.rfind('/')) != std::string::npos;
}

ImageTopics choose_image_topics(const BagContent& content, const OpenOptions& options, const fs::path& bag) {
  const Chooser chooser(content, bag);
  if (!options.left_topic && options.right_topic) {
    throw InputError(bag.string(), "the topic of the right camera is given without that of the left camera",
                     "give both: --left TOPIC --right TOPIC");
  }
  ImageTopics topics;
  if (!options.left_topic) {
    topics = chooser.guessed();
  } else {
    topics.left = chooser.named(*options.left_topic);
    topics.right = options.right_topic ? chooser.named(*options.right_topic) : chooser.right_of(topics.left);
  }
  const bool wants_depth = options.camera ? options.camera == CameraChoice::rgbd : !topics.right;
  if (options.depth_topic) {
    topics.depth = chooser.depth_named(*options.depth_topic);
  } else if (wants_depth) {
    topics.depth = chooser.depth_of(topics.left);
  }
  return topics;
}

std::string camera_info_topic(const std::string& images) {
  return parent_of(images) + "/camera_info";
}

}  // namespace byre
