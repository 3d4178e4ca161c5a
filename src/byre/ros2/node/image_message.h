#pragma once

#include "byre/image.h"
#include "byre/io/ros/messages.h"

#include <cstdint>
#include <string>
#include <vector>

namespace byre {

// Received image in a format for tracking.
struct ReceivedImage {
  ros::Header header;
  ImageView layout{};  // format and size; data is null
  std::vector<std::uint8_t> pixels;

  ImageView view() const {
    ImageView view = layout;
    view.data = pixels.data();
    return view;
  }
};

// Throws InputError for an unsupported encoding, sizes that do not match the data, and an incomplete JPEG or PNG.
// place: the topic.
ReceivedImage received_image(ros::Image message, const std::string& place);
ReceivedImage received_image(const ros::CompressedImage& message, const std::string& place);

}  // namespace byre
