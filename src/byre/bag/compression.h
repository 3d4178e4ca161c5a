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

// Decompresses a file of zstd's frames into another. False when it is cut or damaged: what came before is written.
// Throws InputError when one cannot be read, the other not be written, or more than most bytes are needed, at the
// latest when a tenth of the disk space that was free is left.
bool decompress_zstd_file(const std::filesystem::path& from, const std::filesystem::path& to, std::uint64_t most);

}  // namespace byre
