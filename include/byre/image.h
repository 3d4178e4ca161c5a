#pragma once

#include "byre/trajectory.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace byre {

// 8-bit grey image, row-major, without padding.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

// Depths in units of DepthCamera::units_per_metre, zero if invalid; row-major, without padding.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> units;
};

// Decoded images of one frame of a recording.
struct ImageFrame {
  Timestamp time{};
  Image left;
  std::optional<Image> right;
  std::optional<DepthImage> depth{};
};

//   grey8, grey16   one number per pixel; grey16 from 0 to 2^ImageView::bits - 1
//   bgr8, rgb8      three bytes per pixel
//   yuyv            four bytes per two pixels, Y0 U Y1 V (YUV 4:2:2)
//   nv12            a plane of Y, then a plane of U and V per four pixels (YUV 4:2:0); width and height are even
//   depth16         units of DepthCamera::units_per_metre; zero is invalid
//   depth_metres    32-bit float; zero or NaN is invalid
enum class PixelFormat : std::uint8_t { grey8, grey16, bgr8, rgb8, yuyv, nv12, depth16, depth_metres };

// Caller's image, borrowed for the duration of a call. Multi-byte numbers are in native byte order.
struct ImageView {
  const void* data = nullptr;
  int width = 0;           // pixels
  int height = 0;          // pixels
  std::size_t stride = 0;  // bytes from one row to the next; zero: no padding
  PixelFormat format = PixelFormat::grey8;
  int bits = 16;     // significant bits of a grey16 pixel, such as 12 for a camera that counts to 4095
  Timestamp time{};  // middle of the exposure, by any monotonic clock
};

// Images of all cameras at one time.
struct CameraImages {
  ImageView left;
  // Second image of a stereo pair, or of a depth camera. A time of zero means the time of the left image.
  std::optional<ImageView> right{};
  std::optional<ImageView> depth{};
};

// Views of a recorded frame's images; valid as long as the frame.
CameraImages view_of(const ImageFrame& frame);

}  // namespace byre
