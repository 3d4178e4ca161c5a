#pragma once

#include "byre/io/bag/bag.h"
#include "byre/recording.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace byre {

// Image topics of a recording, by their numbers in the bag.
struct ImageTopics {
  std::size_t left = 0;
  std::optional<std::size_t> right{};
  std::optional<std::size_t> depth{};
};

// Whether a topic has images of a camera: a supported type, not depths, at least one message.
bool is_image_topic(const BagTopic& topic);

// Whether a topic has depth images, by its name: a supported type, and at least one message.
bool is_depth_topic(const BagTopic& topic);

// Whether depth images are registered to the colour camera, by the name of their topic.
bool is_registered(const BagTopic& topic);

// Whether the images are rectified, by the name of the topic.
bool is_rectified(const BagTopic& topic);

// Whether a topic has transforms between frames, by its type.
bool is_transform_topic(const BagTopic& topic);

// Image topics: those in the options; else the only pair with names of a left and a right camera, or the only image
// topic. Raw images are preferred to compressed ones of the same camera, and the least processed kind of several.
// The depth topic is that of the options; else, without a right camera or for CameraChoice::rgbd, the one whose name
// has most in common with the left topic, registered and raw ones first. Throws InputError with a list of the image
// topics if the choice is ambiguous.
ImageTopics choose_image_topics(const BagContent& content, const OpenOptions& options,
                                const std::filesystem::path& bag);

// The camera info topic for an image topic, by its name: "/left/camera_info" for "/left/image_raw" and
// "/left/image_raw/compressed".
std::string camera_info_topic(const std::string& images);

}  // namespace byre
