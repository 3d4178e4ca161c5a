#include "byre/io/bag/byte_source.h"

#include "byre/base/regular_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace byre {

std::vector<std::byte> read_piece(ByteSource& source, std::uint64_t begin, std::uint64_t most) {
  const std::uint64_t left = source.size() - std::min(begin, source.size());
  std::vector<std::byte> piece(std::min(most, left));
  if (!piece.empty()) source.read(begin, piece);
  return piece;
}

FileSource::FileSource(const std::filesystem::path& path) : path_(path) {
  refuse_pipe(path);
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor_ < 0 || fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    const std::string reason = descriptor_ < 0 || !S_ISDIR(status.st_mode) ? std::strerror(errno) : "it is a folder";
    if (descriptor_ >= 0) close(descriptor_);
    throw InputError(path.string(), "cannot be opened: " + reason, "check that the file exists and is readable");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

FileSource::~FileSource() {
  close(descriptor_);
}

void FileSource::read_directly(std::uint64_t begin, std::span<std::byte> piece) const {
  while (!piece.empty()) {
    const ssize_t count = pread(descriptor_, piece.data(), piece.size(), static_cast<off_t>(begin));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      throw InputError(
          path_.string(),
          count < 0 ? std::string("cannot be read: ") + std::strerror(errno) : "was truncated while being read",
          "check the disk, and that no program writes to the file");
    }
    piece = piece.subspan(static_cast<std::size_t>(count));
    begin += static_cast<std::uint64_t>(count);
  }
}

void FileSource::read(std::uint64_t begin, std::span<std::byte> piece) {
  if (piece.size() > window_.size()) return read_directly(begin, piece);
  if (begin < window_begin_ || begin + piece.size() > window_begin_ + window_size_) {
    window_size_ = 0;
    const std::size_t size = std::min<std::uint64_t>(window_.size(), size_ - begin);
    read_directly(begin, std::span(window_).first(size));
    window_begin_ = begin;
    window_size_ = size;
  }
  std::memcpy(piece.data(), window_.data() + (begin - window_begin_), piece.size());
}

void MemorySource::read(std::uint64_t begin, std::span<std::byte> piece) {
  std::ranges::copy(bytes_.subspan(begin, piece.size()), piece.begin());
}

}  // namespace byre
