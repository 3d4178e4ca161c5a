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

// Accepts the names used in bags: "", "none", "zstd", "lz4", "bz2". Empty for any other.
std::optional<Compression> parse_compression(std::string_view text);

// Result of decompression: everything, or the bytes before the fault.
struct Decompressed {
  std::vector<std::byte> bytes;
  bool is_whole = false;  // the compressed data ended, and all of it was decompressed
};

// Decompresses at most `most` bytes; memory grows with the output, independent of stated sizes.
Decompressed decompress(Compression compression, std::span<const std::byte> bytes, std::size_t most);

// Whether the bytes begin with the magic number of zstd frames.
bool is_zstd(std::span<const std::byte> bytes);

std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes);

// Decompresses a file of zstd frames into another. False if it is truncated or damaged; the part before is written.
// Throws InputError if a file cannot be read or written, and if the output exceeds `most` bytes or nine tenths of the
// free disk space.
bool decompress_zstd_file(const std::filesystem::path& from, const std::filesystem::path& to, std::uint64_t most);

}  // namespace byre
