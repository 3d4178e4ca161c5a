#include "byre/dataset/png_chunks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include <libdeflate.h>

namespace byre {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t kFrame = 12;  // bytes of a chunk beside its data: length and type before it, checksum after it

std::size_t number_at(Bytes bytes, std::size_t place) {
  std::size_t number = 0;
  for (const std::uint8_t byte : bytes.subspan(place, 4)) number = number << 8 | byte;
  return number;
}

std::string_view type_of(Bytes chunk) {
  return {reinterpret_cast<const char*>(chunk.data()) + 4, 4};
}

// The chunk that begins there; empty when the file ends before it, or its checksum is wrong.
std::optional<Bytes> chunk_at(Bytes bytes, std::size_t begin) {
  if (bytes.size() - begin < kFrame) return std::nullopt;
  const std::size_t length = number_at(bytes, begin);
  if (length > bytes.size() - begin - kFrame) return std::nullopt;
  const Bytes chunk = bytes.subspan(begin, length + kFrame);
  const std::uint32_t checksum = libdeflate_crc32(0, chunk.data() + 4, length + 4);
  return checksum == number_at(chunk, length + 8) ? std::optional(chunk) : std::nullopt;
}

// Those that begin with a capital must be understood by all; transparency too changes what is seen.
bool is_of_pixels(std::string_view type) {
  return (type[0] >= 'A' && type[0] <= 'Z') || type == "tRNS";
}

}  // namespace

bool is_png(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kSignature.size() && std::ranges::equal(bytes.first<kSignature.size()>(), kSignature);
}

std::optional<std::vector<std::uint8_t>> png_of_pixels(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> pixels(kSignature.begin(), kSignature.end());
  pixels.reserve(bytes.size());
  for (std::size_t begin = kSignature.size();;) {
    const std::optional<Bytes> chunk = chunk_at(bytes, begin);
    if (!chunk) return std::nullopt;
    if (is_of_pixels(type_of(*chunk))) pixels.insert(pixels.end(), chunk->begin(), chunk->end());
    if (type_of(*chunk) == "IEND") return pixels;
    begin += chunk->size();
  }
}

std::vector<PngChunk> chunks_of(std::span<const std::uint8_t> bytes) {
  std::vector<PngChunk> chunks;
  std::size_t begin = kSignature.size();
  while (const std::optional<Bytes> chunk = chunk_at(bytes, begin)) {
    chunks.push_back({type_of(*chunk), chunk->subspan(8, chunk->size() - kFrame)});
    if (chunks.back().type == "IEND") break;
    begin += chunk->size();
  }
  return chunks;
}

}  // namespace byre
