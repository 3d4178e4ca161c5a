#pragma once

#include "byre/io/bag/bag.h"
#include "byre/io/image/image_file.h"
#include "byre/io/ros/messages.h"

namespace byre {

// Image of a message as 8-bit grey, or the reason of failure. Encodings of raw images: mono8, mono16, bgr8, rgb8,
// bgra8, rgba8, yuyv, uyvy, nv12, bayer_rggb8 and the like, also by their alternative names; of compressed ones JPEG
// and PNG.
// bits: bits in use of 16-bit images.
ImageReading<Image> image_of(Bag& bag, const BagMessage& message, int bits = kWordBits);

ImageReading<Image> grey_of(const ros::Image& image, int bits = kWordBits);

// Largest value of a raw image of 16-bit grey; empty for other messages.
std::optional<std::uint16_t> largest_value(Bag& bag, const BagMessage& message);

// Units of depths in metres (32FC1) per metre: resolution 0.2 mm, up to 13.1 m, which is beyond what depth cameras
// measure. Depths beyond are invalid.
inline constexpr double kUnitsOfMetres = 5000.0;
inline constexpr double kUnitsOfMillimetres = 1000.0;  // units of 16UC1 depths per metre (REP-118)

struct DepthMessage {
  ImageReading<DepthImage> reading;
  bool is_in_metres = false;  // the message holds metres; its units are kUnitsOfMetres
};

// Depth image of a message: 16UC1, mono16 or 32FC1, also as PNG by compressed_depth_image_transport or in a compressed
// image.
DepthMessage depth_of(const ros::Image& image);
DepthMessage depth_of(const ros::CompressedImage& image);
DepthMessage depth_of(Bag& bag, const BagMessage& message);

// Time stamp in the message's header, decoded from the first bytes of the message.
Timestamp stamp_of(const BagContent& content, const BagMessage& message);

}  // namespace byre
