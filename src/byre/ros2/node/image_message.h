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

// Received depth image.
struct ReceivedDepth {
  ros::Header header;
  DepthImage image;
  bool is_in_metres = false;  // the message holds metres; the image has kUnitsOfMetres

  // time: of the clock of the left image.
  ImageView view(Timestamp time) const {
    return {image.units.data(), image.width, image.height, 0, PixelFormat::depth16, 16, time};
  }
};

// Throws InputError for an unsupported encoding, sizes that do not match the data, and an incomplete JPEG or PNG.
// place: the topic.
ReceivedImage received_image(ros::Image message, const std::string& place);
ReceivedImage received_image(const ros::CompressedImage& message, const std::string& place);

// Depth images as in bags, see depth_of. Throws InputError for others.
ReceivedDepth received_depth(const ros::Image& message, const std::string& place);
ReceivedDepth received_depth(const ros::CompressedImage& message, const std::string& place);

}  // namespace byre
