#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace byre {

bool is_png(std::span<const std::uint8_t> bytes);

// What the pixels of a PNG file are made of, and nothing else (PNG specification, section 5): of profiles and the like
// that do not suit it, and of damage, the decoder would tell on the standard error stream. Empty when the file is cut
// off or damaged. Precondition: is_png(bytes).
std::optional<std::vector<std::uint8_t>> png_of_pixels(std::span<const std::uint8_t> bytes);

struct PngChunk {
  std::string_view type;  // four letters
  std::span<const std::uint8_t> data;
};

// The chunks up to the last one, or to what is cut off or damaged. Precondition: is_png(bytes).
std::vector<PngChunk> chunks_of(std::span<const std::uint8_t> bytes);

}  // namespace byre
