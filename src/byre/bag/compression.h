#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace byre {

enum class Compression : std::uint8_t { none, zstd, lz4, bz2 };  // lz4: frames, not bare blocks

std::string_view to_string(Compression compression);

// Named by the words that bags use: "", "none", "zstd", "lz4", "bz2". Empty for any other.
std::optional<Compression> parse_compression(std::string_view text);

// What came of decompressing: all, or the bytes before the fault.
struct Decompressed {
  std::vector<std::byte> bytes;
  bool is_whole = false;  // the compressed bytes ended, and none were left out
};

// At most so many bytes are made; memory grows as they come, whatever the bytes claim.
Decompressed decompress(Compression compression, std::span<const std::byte> bytes, std::size_t most);

// Whether they begin as zstd's frames do.
bool is_zstd(std::span<const std::byte> bytes);

std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes);

// Decompresses a file of zstd frames into another. False if it is cut or damaged; the part before is written. Throws
// InputError if one cannot be read or the other not be written, and if it needs more than `most` bytes or nine tenths
// of the free disk space.
bool decompress_zstd_file(const std::filesystem::path& from, const std::filesystem::path& to, std::uint64_t most);

}  // namespace byre
