#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

namespace byre {

struct ImageSize {
  std::uint32_t width = 0;
  std::uint32_t height = 0;

  double pixels() const { return static_cast<double>(width) * height; }
};

// Larger images are not decoded, because a file of few bytes may state any size.
inline constexpr double kMaxPixels = 100e6;

// Size from the header of a PNG, JPEG, BMP, TIFF or netpbm image; empty for other formats.
std::optional<ImageSize> stated_size(std::span<const std::uint8_t> bytes);
std::optional<ImageSize> stated_size(const std::filesystem::path& image);  // empty also if the file cannot be read

}  // namespace byre
