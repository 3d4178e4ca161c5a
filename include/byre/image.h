#pragma once

#include "byre/trajectory.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace byre {

// 8-bit grey, row-major, no padding.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

// Depths in units of the camera's own, zero where it has none; row-major, no padding.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> units;
};

struct ImageFrame {
  Timestamp time{};
  Image left;
  std::optional<Image> right;
  std::optional<DepthImage> depth{};
};

//   grey8, grey16   one number a pixel; of grey16 from 0 to 2^ImageView::bits - 1
//   bgr8, rgb8      three bytes a pixel
//   yuyv            four bytes for two pixels, Y0 U Y1 V (YUV 4:2:2)
//   nv12            a plane of Y, below it one of U and V for four pixels each (YUV 4:2:0); width and height are even
//   depth16         Calibration::depth's units, zero where there is no depth
//   depth_metres    32-bit float, zero or NaN where there is no depth
enum class PixelFormat : std::uint8_t { grey8, grey16, bgr8, rgb8, yuyv, nv12, depth16, depth_metres };

// Somebody's image, borrowed for the time of a call. Numbers of several bytes are in the machine's order.
struct ImageView {
  const void* data = nullptr;
  int width = 0;           // pixels
  int height = 0;          // pixels
  std::size_t stride = 0;  // bytes from one row to the next; zero: rows without padding
  PixelFormat format = PixelFormat::grey8;
  int bits = 16;     // significant bits of a grey16 pixel: 12 for a camera that counts to 4095
  Timestamp time{};  // the middle of the exposure, by any clock that never goes back
};

// What the cameras took at one time.
struct CameraImages {
  ImageView left;
  // The second image of a stereo pair or of a depth camera. A time of zero is that of the left image.
  std::optional<ImageView> right{};
  std::optional<ImageView> depth{};
};

// The images of a recording as a camera would hand them over. Valid as long as the frame is.
CameraImages view_of(const ImageFrame& frame);

}  // namespace byre
