#pragma once

#include "byre/io/bag/bag.h"
#include "byre/io/image/image_file.h"
#include "byre/io/ros/messages.h"

namespace byre {

// Image of a message as 8-bit grey, or the reason of failure. Encodings of raw images: mono8, mono16, bgr8, rgb8,
// bgra8, rgba8, yuyv, uyvy, nv12, bayer_rggb8 and the like, also by their alternative names; of compressed ones JPEG
// and PNG.
ImageReading<Image> image_of(Bag& bag, const BagMessage& message);

ImageReading<Image> grey_of(const ros::Image& image);

// Time stamp in the message's header, decoded from the first bytes of the message.
Timestamp stamp_of(const BagContent& content, const BagMessage& message);

}  // namespace byre
