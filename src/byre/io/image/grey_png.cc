#include "byre/io/image/grey_png.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <memory>

#include <libdeflate.h>

namespace byre {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t kFrame = 12;  // bytes of a chunk without its data: length and type before it, checksum after it

std::size_t number_at(Bytes bytes, std::size_t place) {
  std::size_t number = 0;
  for (const std::uint8_t byte : bytes.subspan(place, 4)) number = number << 8 | byte;
  return number;
}

// The chunk at `begin`; empty if it exceeds the file, or its checksum is wrong.
std::optional<Bytes> chunk_at(Bytes bytes, std::size_t begin) {
  if (bytes.size() - begin < kFrame) return std::nullopt;
  const std::size_t length = number_at(bytes, begin);
  if (length > bytes.size() - begin - kFrame) return std::nullopt;
  const Bytes chunk = bytes.subspan(begin, length + kFrame);
  const std::uint32_t checksum = libdeflate_crc32(0, chunk.data() + 4, length + 4);
  return checksum == number_at(chunk, length + 8) ? std::optional(chunk) : std::nullopt;
}

// Critical chunks have a capital first letter; transparency also affects the image.
bool is_of_pixels(std::string_view type) {
  return (type[0] >= 'A' && type[0] <= 'Z') || type == "tRNS";
}

using Bytes = std::span<const std::uint8_t>;

struct Header {
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t bytes_a_pixel = 0;

  std::size_t stride() const { return width * bytes_a_pixel; }  // bytes
};

// Empty for kinds that are not decoded here.
std::optional<Header> header_of(Bytes data) {
  constexpr std::uint8_t kGrey = 0;
  if (data.size() != 13) return std::nullopt;
  const auto number = [&](std::size_t at) {
    return std::size_t{data[at]} << 24U | std::size_t{data[at + 1]} << 16U | std::size_t{data[at + 2]} << 8U |
           std::size_t{data[at + 3]};
  };
  const Header header{number(0), number(4), data[8] / std::size_t{8}};
  const bool is_plain = data[9] == kGrey && data[10] == 0 && data[11] == 0 && data[12] == 0;
  if (!is_plain || (data[8] != 8 && data[8] != 16) || header.width == 0 || header.height == 0) return std::nullopt;
  return header;
}

// Filtered rows, each after the number of its filter; empty if the size differs.
std::vector<std::uint8_t> inflate(Bytes compressed, std::size_t size) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflater(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  std::vector<std::uint8_t> rows(size);
  const bool is_whole = inflater && libdeflate_zlib_decompress(inflater.get(), compressed.data(), compressed.size(),
                                                               rows.data(), rows.size(), nullptr) == LIBDEFLATE_SUCCESS;
  return is_whole ? rows : std::vector<std::uint8_t>();
}

// The one of three neighbours that is nearest to left + above - corner.
int paeth(int left, int above, int corner) {
  const int from_corner_up = above - corner, from_corner_left = left - corner;
  const int by_left = std::abs(from_corner_up), by_above = std::abs(from_corner_left);
  const int by_corner = std::abs(from_corner_up + from_corner_left);
  const int nearer = by_above <= by_corner ? above : corner;
  return by_left <= std::min(by_above, by_corner) ? left : nearer;
}

// Reconstructs a row pixel by pixel from the pixels to the left, above, and above left; zero outside the image.
template <std::size_t BytesAPixel, typename Prediction>
void predict(Bytes differences, const std::uint8_t* above, Prediction prediction, std::uint8_t* row) {
  std::array<int, BytesAPixel> left{}, corner{};
  for (std::size_t i = 0; i + BytesAPixel <= differences.size(); i += BytesAPixel) {
    for (std::size_t byte = 0; byte < BytesAPixel; ++byte) {
      const int up = above[i + byte];
      left[byte] = (differences[i + byte] + prediction(left[byte], up, corner[byte])) & 0xff;
      corner[byte] = up;
      row[i + byte] = static_cast<std::uint8_t>(left[byte]);
    }
  }
}

// Reconstructs one row from its differences and its filter; false for an unknown filter.
template <std::size_t BytesAPixel>
bool unfilter(std::uint8_t filter, Bytes differences, const std::uint8_t* above, std::uint8_t* row) {
  switch (filter) {
    case 0:
      std::ranges::copy(differences, row);
      return true;
    case 1:
      predict<BytesAPixel>(
          differences, above, [](int left, int, int) { return left; }, row);
      return true;
    case 2:
      for (std::size_t i = 0; i < differences.size(); ++i) {
        row[i] = static_cast<std::uint8_t>(differences[i] + above[i]);
      }
      return true;
    case 3:
      predict<BytesAPixel>(
          differences, above, [](int left, int up, int) { return (left + up) / 2; }, row);
      return true;
    case 4:
      predict<BytesAPixel>(
          differences, above, [](int left, int up, int corner) { return paeth(left, up, corner); }, row);
      return true;
    default:
      return false;
  }
}

}  // namespace

std::vector<std::uint8_t> png_signature() {
  return {kSignature.begin(), kSignature.end()};
}

bool is_png(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kSignature.size() && std::ranges::equal(bytes.first<kSignature.size()>(), kSignature);
}

std::optional<std::vector<PngChunk>> png_chunks(std::span<const std::uint8_t> bytes) {
  std::vector<PngChunk> chunks;
  for (std::size_t begin = kSignature.size();;) {
    const std::optional<Bytes> chunk = chunk_at(bytes, begin);
    if (!chunk) return std::nullopt;
    chunks.push_back({*chunk});
    if (chunks.back().type() == "IEND") return chunks;
    begin += chunk->size();
  }
}

std::vector<std::uint8_t> png_of_pixels(std::span<const PngChunk> chunks) {
  std::vector<std::uint8_t> pixels = png_signature();
  for (const PngChunk& chunk : chunks) {
    if (is_of_pixels(chunk.type())) pixels.insert(pixels.end(), chunk.bytes.begin(), chunk.bytes.end());
  }
  return pixels;
}

std::optional<GreyPng> decode_grey_png(std::span<const PngChunk> chunks) {
  std::optional<Header> header;
  std::vector<std::uint8_t> compressed;
  for (const PngChunk& chunk : chunks) {
    const Bytes data = chunk.data();
    if (chunk.type() == "IHDR") header = header_of(data);
    if (chunk.type() == "tRNS") return std::nullopt;
    if (chunk.type() == "IDAT") compressed.insert(compressed.end(), data.begin(), data.end());
  }
  if (!header) return std::nullopt;
  const std::size_t stride = header->stride();
  const std::vector<std::uint8_t> rows = inflate(compressed, header->height * (stride + 1));
  if (rows.empty()) return std::nullopt;
  GreyPng image{
      static_cast<int>(header->width), static_cast<int>(header->height), static_cast<int>(header->bytes_a_pixel), {}};
  image.values.resize(header->height * stride);
  const std::vector<std::uint8_t> nothing(stride, 0);
  for (std::size_t y = 0; y < header->height; ++y) {
    const Bytes differences = Bytes(rows).subspan(y * (stride + 1) + 1, stride);
    std::uint8_t* const row = image.values.data() + y * stride;
    const std::uint8_t* const above = y == 0 ? nothing.data() : row - stride;
    const std::uint8_t filter = rows[y * (stride + 1)];
    const bool is_known = header->bytes_a_pixel == 1 ? unfilter<1>(filter, differences, above, row)
                                                     : unfilter<2>(filter, differences, above, row);
    if (!is_known) return std::nullopt;
  }
  return image;
}

}  // namespace byre
