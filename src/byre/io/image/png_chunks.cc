#include "byre/io/image/png_chunks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

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

}  // namespace byre
