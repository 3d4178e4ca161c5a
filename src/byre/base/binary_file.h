#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace byre {

// Content of a file. Throws InputError if it cannot be read.
std::vector<std::byte> read_file(const std::filesystem::path& path);

// The folder of a file; "." if the path names none.
std::filesystem::path folder_of(const std::filesystem::path& path);

// An open file that is read piece by piece. Keeps reading the same file if its path is replaced. Thread-safe reads.
class RandomAccessFile {
 public:
  explicit RandomAccessFile(const std::filesystem::path& path);  // throws InputError if it cannot be opened
  ~RandomAccessFile();
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  std::size_t size() const { return size_; }  // bytes, when it was opened
  // Throws InputError if it cannot be read, or is too short.
  void read(std::size_t offset, std::span<std::byte> bytes) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

// Read-only memory map of a file, loaded by page on access; for large files of byre that are not modified in place.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path);  // throws InputError if it cannot be mapped
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace byre
