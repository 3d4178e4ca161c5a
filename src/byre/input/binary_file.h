#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace byre {

// The whole file. Throws InputError when it cannot be read.
std::vector<std::byte> read_file(const std::filesystem::path& path);

// The folder of a file; "." if the path names none.
std::filesystem::path folder_of(const std::filesystem::path& path);

// An open file that is read piece by piece. Stays the same file if another one is put in its path. Several threads may
// read at once.
class PiecewiseFile {
 public:
  explicit PiecewiseFile(const std::filesystem::path& path);  // throws InputError when it cannot be opened
  ~PiecewiseFile();
  PiecewiseFile(const PiecewiseFile&) = delete;
  PiecewiseFile& operator=(const PiecewiseFile&) = delete;

  std::size_t size() const { return size_; }  // when it was opened, bytes
  // Throws InputError when it cannot be read, or ends before.
  void read(std::size_t offset, std::span<std::byte> bytes) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

// A file as read-only memory, loaded page by page as it is looked at; for large files of our own that nobody writes to.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path);  // throws InputError when it cannot be mapped
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace byre
