#include "byre/io/image/image_file.h"

#include "byre/io/image/grey_png.h"
#include "byre/io/image/image_codec.h"
#include "byre/io/image/image_size.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/stat.h>

namespace byre {
namespace {

using OwnBytes = std::vector<std::uint8_t>;

// Content of a file, or the reason of failure. Distinguishes an existing file that cannot be opened, such as when too
// many others are open, from a missing or damaged one.
struct FileBytes {
  OwnBytes bytes;
  std::string failure;
};

FileBytes failed(const char* what) {
  if (errno == ENOENT) return {{}, "does not exist"};
  return {{}, std::string(what) + ": " + std::strerror(errno)};
}

FileBytes read_bytes(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), std::fclose);
  if (!file) return failed("cannot be opened");
  struct stat status {};
  if (fstat(fileno(file.get()), &status) != 0) return failed("cannot be read");
  OwnBytes bytes(status.st_size > 0 ? static_cast<std::size_t>(status.st_size) : 0);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  if (std::ferror(file.get()) != 0) return failed("cannot be read");
  return {std::move(bytes), {}};
}

// The decoder silently fills the missing part of a JPEG with grey; the end marker shows whether it is complete.
bool is_cut_jpeg(const OwnBytes& bytes) {
  constexpr std::array<std::uint8_t, 2> kStart = {0xFF, 0xD8};
  constexpr std::array<std::uint8_t, 2> kEnd = {0xFF, 0xD9};
  constexpr std::size_t kTrailer = 1024;  // some cameras pad their files
  if (bytes.size() < kStart.size() || !std::equal(kStart.begin(), kStart.end(), bytes.begin())) return false;
  const auto tail = bytes.end() - static_cast<std::ptrdiff_t>(std::min(bytes.size(), kTrailer));
  return std::search(tail, bytes.end(), kEnd.begin(), kEnd.end()) == bytes.end();
}

// Empty for kinds that are left to OpenCV.
cv::Mat decode_grey(std::span<const PngChunk> chunks) {
  const std::optional<GreyPng> image = decode_grey_png(chunks);
  if (!image) return {};
  cv::Mat grey(image->height, image->width, image->bytes_a_pixel == 1 ? CV_8U : CV_16U);
  if (image->bytes_a_pixel == 1) {
    std::ranges::copy(image->values, grey.data);
    return grey;
  }
  auto* const values = grey.ptr<std::uint16_t>();
  for (std::size_t i = 0; i < grey.total(); ++i) {
    values[i] = static_cast<std::uint16_t>(image->values[2 * i] << 8U | image->values[2 * i + 1]);
  }
  return grey;
}

cv::Mat decode(const OwnBytes& bytes, int flags) {
  const std::optional<ImageSize> size = stated_size(bytes);
  if (size && size->pixels() > kMaxPixels) return {};
  std::optional<OwnBytes> png;
  if (is_png(bytes)) {
    const std::optional<std::vector<PngChunk>> chunks = png_chunks(bytes);
    if (!chunks) return {};
    const cv::Mat grey = decode_grey(*chunks);
    if (!grey.empty() && (flags == cv::IMREAD_UNCHANGED || grey.type() == CV_8U)) return grey;
    png = png_of_pixels(*chunks);
  }
  try {
    return decode_image(png ? *png : bytes, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // sizes beyond the decoder's limits
    return {};
  }
}

// Whether the bytes are a PNG with 16 bits per channel.
bool has_sixteen_bits(const OwnBytes& bytes) {
  constexpr std::size_t kBitDepth = 24;  // after the signature, the header's length and name, width and height
  return bytes.size() > kBitDepth && is_png(bytes) && bytes[kBitDepth] == kWordBits;
}

// Reduces 16-bit values to grey: the largest value of the bits in use becomes white.
Image grey_of_sixteen_bits(const cv::Mat& pixels, int bits) {
  Image image{pixels.cols, pixels.rows, OwnBytes(pixels.total())};
  cv::Mat grey(image.height, image.width, CV_8U, image.pixels.data());
  pixels.convertTo(grey, CV_8U, 255.0 / ((1 << bits) - 1));
  return image;
}

}  // namespace

int bits_of(std::uint16_t value) {
  for (const int bits : {8, 10, 12, 14}) {
    if (value < 1 << bits) return bits;
  }
  return kWordBits;
}

std::optional<std::uint16_t> largest_value(const std::filesystem::path& path) {
  const auto [bytes, failure] = read_bytes(path);
  if (!has_sixteen_bits(bytes)) return std::nullopt;
  const cv::Mat pixels = decode(bytes, cv::IMREAD_UNCHANGED);
  if (pixels.empty() || pixels.type() != CV_16U) return std::nullopt;
  return *std::max_element(pixels.begin<std::uint16_t>(), pixels.end<std::uint16_t>());
}

ImageReading<Image> try_image(const std::filesystem::path& path, int bits) {
  const auto [bytes, failure] = read_bytes(path);
  if (!failure.empty()) return {std::nullopt, failure};
  return decoded_image(bytes, bits);
}

ImageReading<Image> decoded_image(const std::vector<std::uint8_t>& bytes, int bits) {
  const ImageReading<Image> broken{std::nullopt, "is not a complete image"};
  if (bytes.empty() || is_cut_jpeg(bytes)) return broken;
  if (bits != kWordBits && has_sixteen_bits(bytes)) {
    const cv::Mat pixels = decode(bytes, cv::IMREAD_UNCHANGED);
    if (pixels.empty()) return broken;
    if (pixels.type() == CV_16U) return {grey_of_sixteen_bits(pixels, bits), {}};
  }
  const cv::Mat grey = decode(bytes, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) return broken;
  assert(grey.isContinuous());
  return {Image{grey.cols, grey.rows, OwnBytes(grey.data, grey.data + grey.total())}, {}};
}

ImageReading<DepthImage> try_depth_image(const std::filesystem::path& path) {
  const auto [bytes, failure] = read_bytes(path);
  if (!failure.empty()) return {std::nullopt, failure};
  return decoded_depth_image(bytes);
}

ImageReading<DepthImage> decoded_depth_image(const std::vector<std::uint8_t>& bytes) {
  const ImageReading<DepthImage> broken{std::nullopt, "is not a complete 16-bit image"};
  if (bytes.empty()) return broken;
  const cv::Mat depth = decode(bytes, cv::IMREAD_UNCHANGED);
  if (depth.empty() || depth.type() != CV_16U) return broken;
  return {DepthImage{depth.cols, depth.rows, {depth.begin<std::uint16_t>(), depth.end<std::uint16_t>()}}, {}};
}

std::optional<Image> read_image(const std::filesystem::path& path) {
  return try_image(path).image;
}

std::optional<DepthImage> read_depth_image(const std::filesystem::path& path) {
  return try_depth_image(path).image;
}

Image resize_to_cover(const Image& image, int width, int height) {
  const cv::Mat source(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  const double scale = std::max(static_cast<double>(width) / image.width, static_cast<double>(height) / image.height);
  const cv::Size covering(std::max(width, static_cast<int>(std::lround(image.width * scale))),
                          std::max(height, static_cast<int>(std::lround(image.height * scale))));
  cv::Mat scaled;
  cv::resize(source, scaled, covering, 0.0, 0.0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);

  Image result{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height)};
  const cv::Rect middle((covering.width - width) / 2, (covering.height - height) / 2, width, height);
  scaled(middle).copyTo(cv::Mat(height, width, CV_8U, result.pixels.data()));
  return result;
}

}  // namespace byre
