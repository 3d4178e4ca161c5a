#include "byre/io/image/animated_png.h"

#include "byre/io/image/grey_png.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <numeric>
#include <string_view>

#include <libdeflate.h>

namespace byre {
namespace {

using PngBytes = std::vector<std::uint8_t>;

constexpr unsigned kBits = 5;  // bits of a channel in a colour bin
constexpr std::size_t kBins = 1U << (3 * kBits);
constexpr std::size_t kPaletteColours = 255;  // besides the transparent entry
constexpr std::uint8_t kUnchanged = 0;        // palette index of the transparent entry
constexpr int kCompression = 12;              // level of libdeflate, its highest

std::size_t bin_of(const cv::Vec3b& bgr) {
  constexpr unsigned kDropped = 8 - kBits;
  return static_cast<std::size_t>(bgr[2] >> kDropped) << (2 * kBits) |
         static_cast<std::size_t>(bgr[1] >> kDropped) << kBits | static_cast<std::size_t>(bgr[0] >> kDropped);
}

struct ColourBin {
  std::size_t pixels = 0;
  std::array<std::size_t, 3> sums{};  // red, green, blue

  std::array<std::uint8_t, 3> mean() const {
    std::array<std::uint8_t, 3> rgb{};
    for (std::size_t k = 0; k < 3; ++k) rgb[k] = static_cast<std::uint8_t>((sums[k] + pixels / 2) / pixels);
    return rgb;
  }
};

struct Palette {
  PngBytes rgb = {0, 0, 0};          // three bytes per index; index 0 is transparent
  std::vector<std::uint8_t> of_bin;  // index per bin; of bins without pixels unused
};

std::vector<ColourBin> count_colours(const std::vector<cv::Mat>& frames) {
  std::vector<ColourBin> bins(kBins);
  for (const cv::Mat& frame : frames) {
    for (auto pixel = frame.begin<cv::Vec3b>(); pixel != frame.end<cv::Vec3b>(); ++pixel) {
      ColourBin& bin = bins[bin_of(*pixel)];
      ++bin.pixels;
      for (int k = 0; k < 3; ++k) bin.sums[static_cast<std::size_t>(k)] += (*pixel)[2 - k];
    }
  }
  return bins;
}

std::uint8_t nearest_index(const PngBytes& palette, const std::array<std::uint8_t, 3>& rgb) {
  int least = std::numeric_limits<int>::max();
  std::size_t nearest = 1;
  for (std::size_t index = 1; index < palette.size() / 3; ++index) {
    int distance = 0;
    for (std::size_t k = 0; k < 3; ++k)
      distance += (palette[3 * index + k] - rgb[k]) * (palette[3 * index + k] - rgb[k]);
    if (distance >= least) continue;
    least = distance;
    nearest = index;
  }
  return static_cast<std::uint8_t>(nearest);
}

Palette make_palette(const std::vector<cv::Mat>& frames) {
  const std::vector<ColourBin> bins = count_colours(frames);
  std::vector<std::size_t> order(bins.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&bins](std::size_t bin) { return bins[bin].pixels == 0; });
  std::ranges::stable_sort(order, std::ranges::greater(), [&bins](std::size_t bin) { return bins[bin].pixels; });
  Palette palette;
  for (const std::size_t bin : order) {
    if (palette.rgb.size() / 3 > kPaletteColours) break;
    const auto rgb = bins[bin].mean();
    palette.rgb.insert(palette.rgb.end(), rgb.begin(), rgb.end());
  }
  palette.of_bin.resize(kBins);
  for (const std::size_t bin : order) palette.of_bin[bin] = nearest_index(palette.rgb, bins[bin].mean());
  return palette;
}

bool is_near(const cv::Vec3b& bgr, const PngBytes& palette, std::uint8_t index) {
  constexpr int kTolerance = 9;  // grey values of each channel, about the noise of a camera image
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(bgr[2 - static_cast<int>(k)] - palette[3U * index + k]) > kTolerance) return false;
  }
  return true;
}

// Keeps the colour of the pixel to the left where it is near enough, which makes noise compressible.
PngBytes indices_of(const cv::Mat& frame, const Palette& palette) {
  PngBytes indices;
  indices.reserve(frame.total());
  for (auto pixel = frame.begin<cv::Vec3b>(); pixel != frame.end<cv::Vec3b>(); ++pixel) {
    const bool has_left = indices.size() % static_cast<std::size_t>(frame.cols) != 0;
    const bool keeps_left = has_left && is_near(*pixel, palette.rgb, indices.back());
    indices.push_back(keeps_left ? indices.back() : palette.of_bin[bin_of(*pixel)]);
  }
  return indices;
}

template <typename Number>
void append_number(PngBytes& bytes, Number number) {
  for (std::size_t i = sizeof(Number); i-- > 0;) bytes.push_back(static_cast<std::uint8_t>(number >> (8 * i)));
}

void append_chunk(PngBytes& png, std::string_view type, const PngBytes& data) {
  append_number(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = png.size();
  png.insert(png.end(), type.begin(), type.end());
  png.insert(png.end(), data.begin(), data.end());
  append_number(png, static_cast<std::uint32_t>(libdeflate_crc32(0, png.data() + begin, png.size() - begin)));
}

// Rows of palette indices without filters, compressed.
PngBytes compressed(const PngBytes& indices, const cv::Rect& part, int width) {
  PngBytes rows;
  for (int y = part.y; y < part.y + part.height; ++y) {
    rows.push_back(0);  // filter type none
    const auto row = indices.begin() + static_cast<std::ptrdiff_t>(y) * width + part.x;
    rows.insert(rows.end(), row, row + part.width);
  }
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> deflater(
      libdeflate_alloc_compressor(kCompression), libdeflate_free_compressor);
  if (!deflater) throw std::bad_alloc();
  PngBytes packed(libdeflate_zlib_compress_bound(deflater.get(), rows.size()));
  packed.resize(libdeflate_zlib_compress(deflater.get(), rows.data(), rows.size(), packed.data(), packed.size()));
  return packed;
}

// Replaces pixels equal to those before by the transparent index. Returns the rectangle of the others, at least one
// pixel.
cv::Rect keep_changes(PngBytes& indices, const PngBytes& before, const cv::Size& size) {
  cv::Rect changed;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
      if (indices[i] == before[i]) {
        indices[i] = kUnchanged;
      } else {
        changed |= cv::Rect(x, y, 1, 1);
      }
    }
  }
  return changed.empty() ? cv::Rect(0, 0, 1, 1) : changed;
}

class AnimationWriter {
 public:
  AnimationWriter(const cv::Size& size, std::size_t frames, const Palette& palette)
      : size_(size), png_(png_signature()) {
    PngBytes header;
    append_number(header, static_cast<std::uint32_t>(size.width));
    append_number(header, static_cast<std::uint32_t>(size.height));
    header.insert(header.end(), {8, 3, 0, 0, 0});  // 8 bits a pixel, by palette; not interlaced
    append_chunk(png_, "IHDR", header);
    PngBytes animation;
    append_number(animation, static_cast<std::uint32_t>(frames));
    append_number(animation, std::uint32_t{0});  // repetitions; 0: for ever
    append_chunk(png_, "acTL", animation);
    append_chunk(png_, "PLTE", palette.rgb);
    append_chunk(png_, "tRNS", {0});
  }

  void add(PngBytes indices, std::uint16_t duration_ms) {
    const bool is_first = before_.empty();
    PngBytes whole = indices;
    const cv::Rect part = is_first ? cv::Rect({}, size_) : keep_changes(indices, before_, size_);
    add_control(part, duration_ms);
    PngBytes data;
    if (!is_first) append_number(data, sequence_++);
    const PngBytes packed = compressed(indices, part, size_.width);
    data.insert(data.end(), packed.begin(), packed.end());
    append_chunk(png_, is_first ? "IDAT" : "fdAT", data);
    before_ = std::move(whole);
  }

  PngBytes finish() {
    append_chunk(png_, "IEND", {});
    return std::move(png_);
  }

 private:
  void add_control(const cv::Rect& part, std::uint16_t duration_ms) {
    PngBytes control;
    append_number(control, sequence_++);
    for (const int number : {part.width, part.height, part.x, part.y}) {
      append_number(control, static_cast<std::uint32_t>(number));
    }
    append_number(control, duration_ms);
    append_number(control, std::uint16_t{1000});  // unit of the duration: 1/1000 s
    control.insert(control.end(), {0, 1});        // dispose: none; blend: over
    append_chunk(png_, "fcTL", control);
  }

  cv::Size size_;
  PngBytes png_;
  PngBytes before_;  // indices of the frame before; empty before the first one
  std::uint32_t sequence_ = 0;
};

}  // namespace

std::vector<std::uint8_t> encode_animated_png(const std::vector<cv::Mat>& frames, const AnimationTimes& times) {
  assert(!frames.empty());
  assert(std::ranges::all_of(frames, [&frames](const cv::Mat& frame) {
    return frame.type() == CV_8UC3 && frame.size() == frames.front().size();
  }));
  const Palette palette = make_palette(frames);
  AnimationWriter writer(frames.front().size(), frames.size(), palette);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    writer.add(indices_of(frames[i], palette), i + 1 < frames.size() ? times.frame_ms : times.last_frame_ms);
  }
  return writer.finish();
}

}  // namespace byre
