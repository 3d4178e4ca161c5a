#include "byre/io/recording/bag_image.h"

#include "byre/input_error.h"
#include "byre/io/image/image_size.h"
#include "byre/io/ros/message_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

// Pixel layout of an encoding, and its conversion to grey.
struct Layout {
  std::string_view encoding;
  int type = CV_8UC1;  // OpenCV's type of the plane that is read
  std::optional<int> to_grey{};
};

// Names of sensor_msgs/image_encodings.hpp; OpenCV names a Bayer pattern by its second row.
constexpr std::array kLayouts = {
    Layout{"mono8"},
    Layout{"8UC1"},
    Layout{"nv12"},
    Layout{"nv21"},
    Layout{"mono16", CV_16UC1},
    Layout{"16UC1", CV_16UC1},
    Layout{"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
    Layout{"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY},
    Layout{"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
    Layout{"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY},
    Layout{"8UC4", CV_8UC4, cv::COLOR_BGRA2GRAY},
    Layout{"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY},
    Layout{"yuyv", CV_8UC2, cv::COLOR_YUV2GRAY_YUYV},
    Layout{"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUYV},
    Layout{"uyvy", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    Layout{"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    Layout{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY},
    Layout{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY},
    Layout{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY},
    Layout{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY},
};

// The beginning of a header, contained in a message's first bytes.
struct HeaderStamp {
  ros::Time stamp{};
  std::uint32_t seq = 0;
  static void fields(auto& self, auto& visit) {
    visit.ros1_only(self.seq);
    visit("stamp", self.stamp);
  }
};

// Bytes of the plane that is read; its last row needs no padding.
std::size_t bytes_needed(const ros::Image& image, int type) {
  const std::size_t row = std::size_t{image.width} * static_cast<std::size_t>(CV_ELEM_SIZE(type));
  return image.step < row ? SIZE_MAX : std::size_t{image.step} * (image.height - 1) + row;
}

void swap_bytes(cv::Mat& numbers) {
  for (int row = 0; row < numbers.rows; ++row) {
    std::uint16_t* const begin = numbers.ptr<std::uint16_t>(row);
    std::transform(begin, begin + numbers.cols, begin,
                   [](std::uint16_t number) { return static_cast<std::uint16_t>(number << 8 | number >> 8); });
  }
}

void copy_grey(const ros::Image& image, const Layout& layout, int bits, cv::Mat& grey) {
  const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), layout.type,
                       const_cast<std::uint8_t*>(image.data.data()), image.step);
  if (layout.to_grey) return cv::cvtColor(pixels, grey, *layout.to_grey);
  if (layout.type != CV_16UC1) return pixels.copyTo(grey);
  cv::Mat numbers = pixels.clone();
  if (image.is_bigendian != 0) swap_bytes(numbers);
  numbers.convertTo(grey, CV_8U, 255.0 / ((1 << bits) - 1));
}

// Metres as units; zero for invalid depths and those out of range.
std::uint16_t units_of(float metres) {
  constexpr double kMost = 65535.0;
  const double units = std::round(kUnitsOfMetres * static_cast<double>(metres));
  return units >= 1.0 && units <= kMost ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

template <typename Number>
DepthImage depth_image(const cv::Mat& pixels) {
  DepthImage depth{pixels.cols, pixels.rows, {}};
  depth.units.reserve(pixels.total());
  for (int row = 0; row < pixels.rows; ++row) {
    for (const Number* value = pixels.ptr<Number>(row); value != pixels.ptr<Number>(row) + pixels.cols; ++value) {
      if constexpr (std::is_same_v<Number, float>) {
        depth.units.push_back(units_of(*value));
      } else {
        depth.units.push_back(*value);
      }
    }
  }
  return depth;
}

}  // namespace

DepthMessage depth_of(const ros::Image& image) {
  const bool is_metric = image.encoding == "32FC1";
  if (!is_metric && image.encoding != "16UC1" && image.encoding != "mono16") {
    return {{std::nullopt, "has the encoding \"" + image.encoding + "\", which is not of depths (16UC1, 32FC1)"}};
  }
  const int type = is_metric ? CV_32FC1 : CV_16UC1;
  const bool is_sound = image.width > 0 && image.height > 0 &&
                        ImageSize{image.width, image.height}.pixels() <= kMaxPixels &&
                        image.data.size() >= bytes_needed(image, type) && image.step % CV_ELEM_SIZE1(type) == 0;
  if (!is_sound) return {{std::nullopt, "is not a complete depth image"}};
  if (is_metric && image.is_bigendian != 0) return {{std::nullopt, "has big-endian depths, which are not supported"}};
  const cv::Mat source(static_cast<int>(image.height), static_cast<int>(image.width), type,
                       const_cast<std::uint8_t*>(image.data.data()), image.step);
  cv::Mat pixels = source.clone();
  if (is_metric) return {{depth_image<float>(pixels), {}}, true};
  if (image.is_bigendian != 0) swap_bytes(pixels);
  return {{depth_image<std::uint16_t>(pixels), {}}};
}

// compressed_depth_image_transport: the header (i32 kind, f32 a, f32 b), then a PNG of depths, or of a / depth + b for
// depths in metres.
DepthMessage depth_of(const ros::CompressedImage& image) {
  constexpr std::size_t kHeader = 12;
  const bool has_header = image.format.find("compressedDepth") != std::string::npos;
  if (image.format.find("rvl") != std::string::npos) {
    return {
        {std::nullopt, "has depths compressed as RVL, which is not read; record PNG (depth_image_transport format)"}};
  }
  if (has_header && image.data.size() < kHeader) return {{std::nullopt, "is not a complete depth image"}};
  const auto begin = image.data.begin() + (has_header ? static_cast<std::ptrdiff_t>(kHeader) : 0);
  ImageReading<DepthImage> depth = decoded_depth_image({begin, image.data.end()});
  if (!depth.image || !has_header || !image.format.starts_with("32FC1")) return {std::move(depth)};
  std::array<float, 2> scale{};
  std::memcpy(scale.data(), image.data.data() + sizeof(float), sizeof(scale));
  for (std::uint16_t& value : depth.image->units) {
    value = value == 0 ? std::uint16_t{0} : units_of(scale[0] / (static_cast<float>(value) - scale[1]));
  }
  return {std::move(depth), true};
}

DepthMessage depth_of(Bag& bag, const BagMessage& message) {
  const BagTopic& topic = bag.content().topics[message.topic];
  try {
    const std::vector<std::byte> bytes = bag.read(message);
    const ros::Encoding encoding = *encoding_of(topic);
    if (holds<ros::Image>(topic)) return depth_of(ros::read_message<ros::Image>(bytes, encoding, topic.name));
    return depth_of(ros::read_message<ros::CompressedImage>(bytes, encoding, topic.name));
  } catch (const InputError& error) {
    return {{std::nullopt, error.reason()}};
  }
}

ImageReading<Image> grey_of(const ros::Image& image, int bits) {
  const auto layout = std::ranges::find(kLayouts, image.encoding, &Layout::encoding);
  if (layout == kLayouts.end()) {
    return {std::nullopt, "has the unsupported encoding \"" + image.encoding + "\""};
  }
  const ImageSize size{image.width, image.height};
  if (image.width == 0 || image.height == 0 || size.pixels() > kMaxPixels) {
    return {std::nullopt, "has an invalid size"};
  }
  if (image.data.size() < bytes_needed(image, layout->type)) return {std::nullopt, "is not a complete image"};
  if (image.step % CV_ELEM_SIZE1(layout->type) != 0) {
    return {std::nullopt,
            "has rows of " + std::to_string(image.step) + " bytes, not a multiple of the size of a channel value"};
  }
  Image result{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  result.pixels.resize(std::size_t{image.width} * image.height);
  cv::Mat grey(result.height, result.width, CV_8UC1, result.pixels.data());
  try {
    copy_grey(image, *layout, bits, grey);
  } catch (const cv::Exception& exception) {  // sizes that a conversion does not support
    return {std::nullopt, "cannot be converted from \"" + image.encoding + "\": " + exception.err};
  }
  return {std::move(result), {}};
}

ImageReading<Image> image_of(Bag& bag, const BagMessage& message, int bits) {
  const BagTopic& topic = bag.content().topics[message.topic];
  try {
    const std::vector<std::byte> bytes = bag.read(message);
    const ros::Encoding encoding = *encoding_of(topic);
    if (holds<ros::Image>(topic)) return grey_of(ros::read_message<ros::Image>(bytes, encoding, topic.name), bits);
    const auto compressed = ros::read_message<ros::CompressedImage>(bytes, encoding, topic.name);
    ImageReading<Image> image = decoded_image(compressed.data, bits);
    if (!image.image) image.failure += " (format \"" + compressed.format + "\"; supported: JPEG and PNG)";
    return image;
  } catch (const InputError& error) {
    return {std::nullopt, error.reason()};
  }
}

std::optional<std::uint16_t> largest_value(Bag& bag, const BagMessage& message) {
  const BagTopic& topic = bag.content().topics[message.topic];
  if (!holds<ros::Image>(topic)) return std::nullopt;
  try {
    const auto image = ros::read_message<ros::Image>(bag.read(message), *encoding_of(topic), topic.name);
    if (image.encoding != "mono16") return std::nullopt;
    const ImageReading<DepthImage> values = depth_of(image).reading;
    if (!values.image) return std::nullopt;
    return std::ranges::max(values.image->units);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

Timestamp stamp_of(const BagContent& content, const BagMessage& message) {
  try {
    return ros::to_nanoseconds(
        ros::read_message<HeaderStamp>(message.head, *encoding_of(content.topics[message.topic]), "").stamp);
  } catch (const InputError&) {  // too short for a stamp
    return {};
  }
}

}  // namespace byre
