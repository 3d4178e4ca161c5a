#pragma once

#include "byre/bag/bag.h"
#include "byre/recording.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// The topics of a recording's images, by their numbers in the bag.
struct ImageTopics {
  std::size_t left = 0;
  std::optional<std::size_t> right{};
};

// Whether a topic is of images that can be a camera's: of a type that is read, with messages, and not of depths.
bool is_of_images(const BagTopic& topic);

// Whether its images are rectified, as its name tells.
bool is_rectified(const BagTopic& topic);

// The topics that the options name; where they name none, the only pair whose names differ as those of left and right
// cameras do, or the only topic of images. Of raw and compressed images of one camera the raw ones are taken, of
// several kinds the least processed. Throws InputError, listing the topics of images, where that leaves a choice.
ImageTopics choose_image_topics(const BagContent& content, const OpenOptions& options,
                                const std::filesystem::path& bag);

// The topic of the camera info that goes with a topic of images, by its name: "/left/camera_info" for
// "/left/image_raw" and "/left/image_raw/compressed".
std::string camera_info_topic(const std::string& images);

}  // namespace byre
