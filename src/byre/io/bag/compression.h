#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace byre {

// Random access to bytes.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  // Fills the piece with the bytes at `begin`. Throws InputError if they cannot be read. Precondition: they are within
  // size().
  virtual void read(std::uint64_t begin, std::span<std::byte> piece) = 0;
};

// At most `most` bytes at `begin`, fewer at the end.
std::vector<std::byte> read_piece(ByteSource& source, std::uint64_t begin, std::uint64_t most);

// A file; neighbouring small reads cost one system call.
class FileSource final : public ByteSource {
 public:
  explicit FileSource(const std::filesystem::path& path);  // throws InputError if it cannot be opened
  ~FileSource() override;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;

  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t begin, std::span<std::byte> piece) override;

 private:
  void read_directly(std::uint64_t begin, std::span<std::byte> piece) const;

  std::filesystem::path path_;            // constant after construction
  int descriptor_ = -1;                   // constant after construction
  std::uint64_t size_ = 0;                // constant after construction
  std::array<std::byte, 4096> window_{};  // bytes of the file around the last small piece
  std::uint64_t window_begin_ = 0;
  std::size_t window_size_ = 0;
};

// Bytes in memory, borrowed.
class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t begin, std::span<std::byte> piece) override;

 private:
  std::span<const std::byte> bytes_;
};

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
