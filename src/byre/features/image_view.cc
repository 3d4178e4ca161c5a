#include "byre/features/image_view.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

// OpenCV's type of the pixels in the first plane.
int type_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::yuyv:
      return CV_8UC2;
    case PixelFormat::bgr8:
    case PixelFormat::rgb8:
      return CV_8UC3;
    case PixelFormat::grey16:
    case PixelFormat::depth16:
      return CV_16UC1;
    case PixelFormat::depth_metres:
      return CV_32FC1;
    default:
      return CV_8UC1;
  }
}

std::size_t bytes_of_row(const ImageView& view) {
  return static_cast<std::size_t>(CV_ELEM_SIZE(type_of(view.format))) * static_cast<std::size_t>(view.width);
}

std::size_t stride_of(const ImageView& view) {
  return view.stride != 0 ? view.stride : bytes_of_row(view);
}

// Without a copy; cv::Mat has no const pixels.
cv::Mat pixels_of(const ImageView& view) {
  return {view.height, view.width, type_of(view.format), const_cast<void*>(view.data), stride_of(view)};
}

std::uint16_t units_of(float metres, double units_per_metre) {
  if (!(metres > 0.0f)) return 0;  // NaN included
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  const double units = std::round(metres * units_per_metre);
  return units <= kMost ? static_cast<std::uint16_t>(units) : 0;
}

}  // namespace

CameraImages view_of(const ImageFrame& frame) {
  const auto grey = [&](const Image& image) {
    return ImageView{image.pixels.data(), image.width, image.height, 0, PixelFormat::grey8, 16, frame.time};
  };
  CameraImages images{grey(frame.left)};
  if (frame.right) images.right = grey(*frame.right);
  if (frame.depth) {
    images.depth = ImageView{
        frame.depth->units.data(), frame.depth->width, frame.depth->height, 0, PixelFormat::depth16, 16, frame.time};
  }
  return images;
}

bool is_depth(PixelFormat format) {
  return format == PixelFormat::depth16 || format == PixelFormat::depth_metres;
}

bool is_sound(const ImageView& view) {
  if (view.width <= 0 || view.height <= 0) return false;
  if (view.format == PixelFormat::grey16 && (view.bits < 1 || view.bits > 16)) return false;
  const auto alignment = static_cast<std::size_t>(CV_ELEM_SIZE1(type_of(view.format)));  // multi-byte numbers
  if (stride_of(view) % alignment != 0 || std::bit_cast<std::uintptr_t>(view.data) % alignment != 0) return false;
  if (stride_of(view) < bytes_of_row(view)) return false;
  if (view.format == PixelFormat::yuyv) return view.width % 2 == 0;
  return view.format != PixelFormat::nv12 || (view.width % 2 == 0 && view.height % 2 == 0);
}

CopiedImages::CopiedImages(const CameraImages& images) : views_(images) {
  const auto copy = [this](ImageView& view) {
    if (view.data == nullptr || !is_sound(view)) return;
    const auto* const first = static_cast<const std::byte*>(view.data);
    const std::size_t bytes = stride_of(view) * static_cast<std::size_t>(view.height - 1) + bytes_of_row(view);
    view.data = pixels_.emplace_back(first, first + bytes).data();
  };
  copy(views_.left);
  if (views_.right) copy(*views_.right);
  if (views_.depth) copy(*views_.depth);
}

void copy_grey(const ImageView& view, Image& grey) {
  assert(is_sound(view) && !is_depth(view.format));
  grey.width = view.width;
  grey.height = view.height;
  grey.pixels.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const cv::Mat from = pixels_of(view);
  cv::Mat to(view.height, view.width, CV_8UC1, grey.pixels.data());
  switch (view.format) {
    case PixelFormat::bgr8:
      return cv::cvtColor(from, to, cv::COLOR_BGR2GRAY);
    case PixelFormat::rgb8:
      return cv::cvtColor(from, to, cv::COLOR_RGB2GRAY);
    case PixelFormat::yuyv:
      return cv::cvtColor(from, to, cv::COLOR_YUV2GRAY_YUYV);
    case PixelFormat::grey16:
      return from.convertTo(to, CV_8U, 255.0 / ((1 << view.bits) - 1));
    default:
      return from.copyTo(to);
  }
}

void copy_depth(const ImageView& view, double units_per_metre, DepthImage& depth) {
  assert(is_sound(view) && is_depth(view.format));
  depth.width = view.width;
  depth.height = view.height;
  depth.units.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const cv::Mat from = pixels_of(view);
  cv::Mat to(view.height, view.width, CV_16UC1, depth.units.data());
  if (view.format == PixelFormat::depth16) return from.copyTo(to);
  for (int row = 0; row < view.height; ++row) {
    std::transform(from.ptr<float>(row), from.ptr<float>(row) + view.width, to.ptr<std::uint16_t>(row),
                   [units_per_metre](float metres) { return units_of(metres, units_per_metre); });
  }
}

}  // namespace byre
