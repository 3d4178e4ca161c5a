#include "byre/dataset/image_file.h"

#include "byre/dataset/image_size.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <fstream>
#include <system_error>

#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return {};
  Bytes bytes(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  return file ? bytes : Bytes();
}

// The decoder fills the missing part of a JPEG with grey and says nothing; its end marker tells whether it is whole.
bool is_cut_jpeg(const Bytes& bytes) {
  constexpr std::array<std::uint8_t, 2> kStart = {0xFF, 0xD8};
  constexpr std::array<std::uint8_t, 2> kEnd = {0xFF, 0xD9};
  constexpr std::size_t kTrailer = 1024;  // some cameras pad their files
  if (bytes.size() < kStart.size() || !std::equal(kStart.begin(), kStart.end(), bytes.begin())) return false;
  const auto tail = bytes.end() - static_cast<std::ptrdiff_t>(std::min(bytes.size(), kTrailer));
  return std::search(tail, bytes.end(), kEnd.begin(), kEnd.end()) == bytes.end();
}

cv::Mat decode(const Bytes& bytes, int flags) {
  const std::optional<ImageSize> size = stated_size(bytes);
  if (size && size->pixels() > kMostPixels) return {};
  try {
    return cv::imdecode(bytes, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {  // sizes beyond the decoder's limits
    return {};
  }
}

}  // namespace

std::optional<Image> read_image(const std::filesystem::path& path) {
  const Bytes bytes = read_bytes(path);
  if (bytes.empty() || is_cut_jpeg(bytes)) return std::nullopt;
  const cv::Mat grey = decode(bytes, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) return std::nullopt;
  assert(grey.isContinuous());
  return Image{grey.cols, grey.rows, Bytes(grey.data, grey.data + grey.total())};
}

std::optional<DepthImage> read_depth_image(const std::filesystem::path& path) {
  const Bytes bytes = read_bytes(path);
  if (bytes.empty()) return std::nullopt;
  const cv::Mat depth = decode(bytes, cv::IMREAD_UNCHANGED);
  if (depth.empty() || depth.type() != CV_16U) return std::nullopt;
  return DepthImage{depth.cols, depth.rows, {depth.begin<std::uint16_t>(), depth.end<std::uint16_t>()}};
}

}  // namespace byre
