#pragma once

#include "byre/image.h"
#include "byre/ros/messages.h"

#include <cstdint>
#include <string>
#include <vector>

namespace byre {

// An image that came in, in a form that tracking takes.
struct ReceivedImage {
  ros::Header header;
  ImageView about{};  // all but the pixels
  std::vector<std::uint8_t> pixels;

  ImageView view() const {
    ImageView view = about;
    view.data = pixels.data();
    return view;
  }
};

// Throws InputError for an encoding that is not known, for sizes that are not those of the data, and for what is no
// whole JPEG or PNG. place: the topic.
ReceivedImage received_image(ros::Image message, const std::string& place);
ReceivedImage received_image(const ros::CompressedImage& message, const std::string& place);

}  // namespace byre
