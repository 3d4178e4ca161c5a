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

// More are not decoded, as a file of few bytes may state any size.
inline constexpr double kMostPixels = 100e6;

// What the beginning of a PNG, JPEG, BMP, TIFF or netpbm image says of its size; empty for what is none of these.
std::optional<ImageSize> stated_size(std::span<const std::uint8_t> bytes);
std::optional<ImageSize> stated_size(const std::filesystem::path& image);  // empty also when it cannot be read

}  // namespace byre
