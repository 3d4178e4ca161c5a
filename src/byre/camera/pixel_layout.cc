#include "byre/camera/pixel_layout.h"

#include "byre/features/image_view.h"
#include "byre/io/image/image_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include <linux/videodev2.h>

namespace byre {
namespace {

// A readable format; the list is in order of preference.
struct KnownFormat {
  std::uint32_t code = 0;
  PixelFormat format = PixelFormat::grey8;
  int bits = 8;  // significant bits of a pixel of grey16
  bool is_compressed = false;
};

constexpr std::array kKnown = {
    KnownFormat{V4L2_PIX_FMT_GREY},
    KnownFormat{V4L2_PIX_FMT_NV12, PixelFormat::nv12},
    KnownFormat{V4L2_PIX_FMT_Y10, PixelFormat::grey16, 10},
    KnownFormat{V4L2_PIX_FMT_Y12, PixelFormat::grey16, 12},
    KnownFormat{V4L2_PIX_FMT_Y16, PixelFormat::grey16, 16},
    KnownFormat{V4L2_PIX_FMT_YUYV, PixelFormat::yuyv},
    KnownFormat{V4L2_PIX_FMT_BGR24, PixelFormat::bgr8},
    KnownFormat{V4L2_PIX_FMT_RGB24, PixelFormat::rgb8},
    KnownFormat{V4L2_PIX_FMT_MJPEG, PixelFormat::grey8, 8, true},
    KnownFormat{V4L2_PIX_FMT_JPEG, PixelFormat::grey8, 8, true},
};

const KnownFormat* find(std::uint32_t code) {
  const auto* const found = std::ranges::find(kKnown, code, &KnownFormat::code);
  return found != kKnown.end() ? found : nullptr;
}

// Bytes of the last row, which drivers may deliver without padding.
std::size_t bytes_of_row(const KnownFormat& known, int width) {
  const auto pixels = static_cast<std::size_t>(width);
  switch (known.format) {
    case PixelFormat::grey16:
    case PixelFormat::yuyv:
      return 2 * pixels;
    case PixelFormat::bgr8:
    case PixelFormat::rgb8:
      return 3 * pixels;
    default:
      return pixels;
  }
}

std::optional<Image> decompressed(const PixelLayout& layout, std::span<const std::uint8_t> bytes) {
  ImageReading<Image> read = decoded_image({bytes.begin(), bytes.end()});
  const bool is_whole = read.image && read.image->width == layout.width && read.image->height == layout.height;
  return is_whole ? std::move(read.image) : std::nullopt;
}

}  // namespace

std::string four_characters(std::uint32_t code) {
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<char>(code >> shift & 0x7Fu);
    text += letter >= ' ' ? letter : '?';
  }
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::optional<std::uint32_t> parse_four_characters(const std::string& text) {
  if (text.empty() || text.size() > 4) return std::nullopt;
  std::string padded = text;
  padded.resize(4, ' ');
  return v4l2_fourcc(padded[0], padded[1], padded[2], padded[3]);
}

bool is_readable(std::uint32_t code) {
  return find(code) != nullptr;
}

std::string readable_formats() {
  std::string text;
  for (const KnownFormat& known : kKnown) text += (text.empty() ? "" : ", ") + four_characters(known.code);
  return text;
}

std::optional<int> preference_of(std::uint32_t code) {
  const KnownFormat* const known = find(code);
  return known != nullptr ? std::optional(static_cast<int>(known - kKnown.data())) : std::nullopt;
}

std::optional<Image> grey_of(const PixelLayout& layout, std::span<const std::uint8_t> bytes) {
  const KnownFormat* const known = find(layout.code);
  assert(known != nullptr);
  if (known->is_compressed) return decompressed(layout, bytes);
  const std::size_t rows_before_last = static_cast<std::size_t>(std::max(layout.height, 1) - 1) * layout.stride;
  if (bytes.size() < rows_before_last + bytes_of_row(*known, layout.width)) return std::nullopt;
  const ImageView view{bytes.data(),  layout.width, layout.height, layout.stride,
                       known->format, known->bits,  Timestamp{}};
  if (!is_sound(view)) return std::nullopt;
  Image grey;
  copy_grey(view, grey);
  return grey;
}

ImageHalves halves_of(const Image& both) {
  assert(both.width % 2 == 0);
  const int width = both.width / 2;
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(both.height);
  ImageHalves halves{{width, both.height, std::vector<std::uint8_t>(size)},
                     {width, both.height, std::vector<std::uint8_t>(size)}};
  for (int y = 0; y < both.height; ++y) {
    const auto from = both.pixels.begin() + std::ptrdiff_t{y} * both.width;
    const std::ptrdiff_t to = std::ptrdiff_t{y} * width;
    std::copy_n(from, width, halves.left.pixels.begin() + to);
    std::copy_n(from + width, width, halves.right.pixels.begin() + to);
  }
  return halves;
}

}  // namespace byre
