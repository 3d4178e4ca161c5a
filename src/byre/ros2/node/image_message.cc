#include "byre/ros2/node/image_message.h"

#include "byre/input_error.h"
#include "byre/io/image/image_file.h"
#include "byre/io/image/image_size.h"
#include "byre/io/recording/bag_image.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

// Conversion of an encoding of sensor_msgs/image_encodings.hpp, including old names that drivers still send.
struct Encoding {
  std::string_view name;
  PixelFormat format = PixelFormat::grey8;
  int cv_type = CV_8UC1;            // type of the received rows
  std::optional<int> to_grey = {};  // OpenCV's conversion; empty if tracking accepts the format
};

constexpr std::array kEncodings = {
    Encoding{"mono8"},
    Encoding{"8UC1"},
    Encoding{"mono16", PixelFormat::grey16, CV_16UC1},
    Encoding{"16UC1", PixelFormat::grey16, CV_16UC1},
    Encoding{"bgr8", PixelFormat::bgr8, CV_8UC3},
    Encoding{"8UC3", PixelFormat::bgr8, CV_8UC3},
    Encoding{"rgb8", PixelFormat::rgb8, CV_8UC3},
    Encoding{"bgra8", PixelFormat::grey8, CV_8UC4, cv::COLOR_BGRA2GRAY},
    Encoding{"8UC4", PixelFormat::grey8, CV_8UC4, cv::COLOR_BGRA2GRAY},
    Encoding{"rgba8", PixelFormat::grey8, CV_8UC4, cv::COLOR_RGBA2GRAY},
    Encoding{"yuyv", PixelFormat::yuyv, CV_8UC2},
    Encoding{"yuv422_yuy2", PixelFormat::yuyv, CV_8UC2},
    Encoding{"uyvy", PixelFormat::grey8, CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    Encoding{"yuv422", PixelFormat::grey8, CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    // OpenCV names a Bayer pattern by the second and third pixel of its second row.
    Encoding{"bayer_rggb8", PixelFormat::grey8, CV_8UC1, cv::COLOR_BayerBG2GRAY},
    Encoding{"bayer_bggr8", PixelFormat::grey8, CV_8UC1, cv::COLOR_BayerRG2GRAY},
    Encoding{"bayer_gbrg8", PixelFormat::grey8, CV_8UC1, cv::COLOR_BayerGR2GRAY},
    Encoding{"bayer_grbg8", PixelFormat::grey8, CV_8UC1, cv::COLOR_BayerGB2GRAY},
};

void require_size(const ros::Image& message, const Encoding& encoding, const std::string& place) {
  constexpr std::uint32_t kMaxSide = 1u << 16;
  const bool is_of_a_size = message.width > 0 && message.height > 0 && message.width <= kMaxSide &&
                            message.height <= kMaxSide && message.width * double(message.height) <= kMaxPixels;
  const std::size_t number = CV_ELEM_SIZE1(encoding.cv_type);
  const std::size_t row = message.width * static_cast<std::size_t>(CV_ELEM_SIZE(encoding.cv_type));
  if (!is_of_a_size || message.step < row || message.step % number != 0 ||
      message.data.size() < std::size_t{message.step} * message.height) {
    throw InputError(place,
                     "has an image of " + std::to_string(message.width) + " x " + std::to_string(message.height) +
                         " pixels whose rows of " + std::to_string(message.step) +
                         " bytes are truncated or not whole pixels",
                     "check width, height, step and data of the images of the camera driver");
  }
}

ReceivedImage grey_image(ros::Header header, Image grey) {
  ReceivedImage image;
  image.header = std::move(header);
  image.layout = {.width = grey.width, .height = grey.height, .format = PixelFormat::grey8};
  image.pixels = std::move(grey.pixels);
  image.layout.time = ros::to_nanoseconds(image.header.stamp);
  return image;
}

ReceivedDepth depth_or_fault(const ros::Header& header, DepthMessage read, const std::string& place) {
  if (!read.reading.image) {
    throw InputError(place, "has an image that " + read.reading.failure,
                     "set the depth camera driver to 16UC1 or 32FC1, or to compressedDepth as PNG");
  }
  return {header, std::move(*read.reading.image), read.is_in_metres};
}

}  // namespace

ReceivedImage received_image(ros::Image message, const std::string& place) {
  const auto* const encoding = std::ranges::find(kEncodings, message.encoding, &Encoding::name);
  if (encoding == kEncodings.end()) {
    throw InputError(place, "has images of the encoding '" + message.encoding.substr(0, 40) + "'",
                     "set the driver to mono8, mono16, bgr8, rgb8, bgra8, rgba8, yuyv, uyvy or 8-bit Bayer");
  }
  require_size(message, *encoding, place);
  if (encoding->format == PixelFormat::grey16 && message.is_bigendian != 0) {
    throw InputError(place, "has big-endian 16-bit images", "set the driver to mono8");
  }
  const int width = static_cast<int>(message.width), height = static_cast<int>(message.height);
  if (encoding->to_grey) {
    const cv::Mat given(height, width, encoding->cv_type, message.data.data(), message.step);
    Image grey{width, height, std::vector<std::uint8_t>(std::size_t{message.width} * message.height)};
    cv::Mat written(height, width, CV_8UC1, grey.pixels.data());
    try {
      cv::cvtColor(given, written, *encoding->to_grey);
    } catch (const cv::Exception& exception) {  // size not supported by a conversion
      throw InputError(place, "has an image that cannot be converted from '" + message.encoding + "': " + exception.err,
                       "check width, height and encoding of the images of the camera driver");
    }
    return grey_image(std::move(message.header), std::move(grey));
  }
  ReceivedImage image;
  image.header = std::move(message.header);
  image.layout = {.width = width, .height = height, .stride = message.step, .format = encoding->format};
  image.layout.time = ros::to_nanoseconds(image.header.stamp);
  image.pixels = std::move(message.data);
  return image;
}

ReceivedImage received_image(const ros::CompressedImage& message, const std::string& place) {
  ImageReading<Image> decoded = decoded_image(message.data);
  if (!decoded.image) {
    throw InputError(place, "has an image that is not a complete JPEG or PNG ('" + message.format.substr(0, 40) + "')",
                     "check the compression format of the camera driver");
  }
  return grey_image(message.header, std::move(*decoded.image));
}

ReceivedDepth received_depth(const ros::Image& message, const std::string& place) {
  return depth_or_fault(message.header, depth_of(message), place);
}

ReceivedDepth received_depth(const ros::CompressedImage& message, const std::string& place) {
  return depth_or_fault(message.header, depth_of(message), place);
}

}  // namespace byre
