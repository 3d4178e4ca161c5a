#pragma once

#include "byre/bag/bag.h"
#include "byre/dataset/image_file.h"
#include "byre/ros/messages.h"

namespace byre {

// A message's image as 8-bit grey, or why there is none. Encodings of raw images: mono8, mono16, bgr8, rgb8, bgra8,
// rgba8, yuyv, uyvy, nv12, bayer_rggb8 and its like, also by their other names; of compressed ones JPEG and PNG.
ImageReading<Image> image_of(Bag& bag, const BagMessage& message);

ImageReading<Image> grey_of(const ros::Image& image);

// Time stamp in the message's header, by the first bytes of it.
Timestamp stamp_of(const BagContent& content, const BagMessage& message);

}  // namespace byre
