#include "byre/io/image/image_size.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <vector>

namespace byre {
namespace {

using Bytes = std::span<const std::uint8_t>;

enum class Order : std::uint8_t { big, little };

// Zero beyond the end.
std::uint32_t number_at(Bytes bytes, std::size_t at, int size, Order order) {
  std::uint32_t number = 0;
  for (int i = 0; i < size; ++i) {
    const std::size_t place = at + static_cast<std::size_t>(order == Order::big ? i : size - 1 - i);
    number = number << 8 | (place < bytes.size() ? bytes[place] : 0u);
  }
  return number;
}

bool starts_with(Bytes bytes, std::string_view start) {
  return bytes.size() >= start.size() &&
         std::equal(start.begin(), start.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

// The frame header (SOF) follows segments that each state their length.
std::optional<ImageSize> size_of_jpeg(Bytes bytes) {
  std::size_t at = 2;
  while (at + 9 < bytes.size() && bytes[at] == 0xFF) {
    const std::uint8_t marker = bytes[at + 1];
    const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) return ImageSize{number_at(bytes, at + 7, 2, Order::big), number_at(bytes, at + 5, 2, Order::big)};
    at += marker == 0xFF ? 1 : 2 + number_at(bytes, at + 2, 2, Order::big);
  }
  return std::nullopt;
}

std::optional<ImageSize> size_of_tiff(Bytes bytes, Order order) {
  constexpr std::uint32_t kWidth = 256, kHeight = 257, kShort = 3;
  const std::size_t directory = number_at(bytes, 4, 4, order);
  const std::uint32_t entries = number_at(bytes, directory, 2, order);
  ImageSize size;
  for (std::size_t i = 0; i < entries && directory + 12 * i < bytes.size(); ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    const std::uint32_t tag = number_at(bytes, entry, 2, order);
    const int length = number_at(bytes, entry + 2, 2, order) == kShort ? 2 : 4;
    if (tag == kWidth) size.width = number_at(bytes, entry + 8, length, order);
    if (tag == kHeight) size.height = number_at(bytes, entry + 8, length, order);
  }
  return size;
}

// Two numbers after "P1" to "P6", separated by white space and comments.
std::optional<ImageSize> size_of_netpbm(Bytes bytes) {
  std::size_t at = 2;
  const auto take_number = [&] {
    while (at < bytes.size() && std::isdigit(bytes[at]) == 0) {
      if (bytes[at] == '#')
        at = static_cast<std::size_t>(std::find(bytes.begin() + at, bytes.end(), '\n') - bytes.begin());
      ++at;
    }
    std::uint64_t number = 0;
    for (; at < bytes.size() && std::isdigit(bytes[at]) != 0; ++at) {
      number = std::min<std::uint64_t>(10 * number + (bytes[at] - '0'), UINT32_MAX);
    }
    return static_cast<std::uint32_t>(number);
  };
  const std::uint32_t width = take_number();
  return ImageSize{width, take_number()};
}

}  // namespace

std::optional<ImageSize> stated_size(Bytes bytes) {
  if (starts_with(bytes, "\x89PNG"))
    return ImageSize{number_at(bytes, 16, 4, Order::big), number_at(bytes, 20, 4, Order::big)};
  if (starts_with(bytes, "\xFF\xD8")) return size_of_jpeg(bytes);
  if (starts_with(bytes, "BM")) {
    const auto rows = static_cast<std::int32_t>(number_at(bytes, 22, 4, Order::little));  // negative: top-down
    return ImageSize{number_at(bytes, 18, 4, Order::little), static_cast<std::uint32_t>(std::abs(std::int64_t{rows}))};
  }
  if (starts_with(bytes, "II*")) return size_of_tiff(bytes, Order::little);
  if (starts_with(bytes, "MM")) return size_of_tiff(bytes, Order::big);
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') return size_of_netpbm(bytes);
  return std::nullopt;
}

std::optional<ImageSize> stated_size(const std::filesystem::path& image) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(image, error)) return std::nullopt;
  std::ifstream file(image, std::ios::binary);
  const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
  return stated_size(Bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
}

}  // namespace byre
