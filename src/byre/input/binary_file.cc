#include "byre/input/binary_file.h"

#include "byre/input/regular_file.h"
#include "byre/input_error.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string_view what, std::string_view remedy) {
  throw InputError(path.string(), std::string(what) + ": " + std::strerror(errno), remedy);
}

constexpr std::string_view kReadRemedy = "check that the file exists and may be read";
constexpr std::string_view kChangeRemedy = "put another file in its place rather than to change it while it is in use";
constexpr std::string_view kWriteRemedy = "check that its folder exists, may be written to and has space";

[[noreturn]] void fail_to_write(const fs::path& path) {
  if (errno == ENOSPC || errno == EDQUOT) fail(path, "cannot be written", "make space, or name a file on another disk");
  if (errno == EFBIG) fail(path, "cannot be written", "raise the limit of file sizes (ulimit -f)");
  fail(path, "cannot be written", kWriteRemedy);
}

// An open file, closed at the end of its life.
class OpenFile {
 public:
  OpenFile(const fs::path& path, int flags, std::string_view remedy)
      : path_(path), descriptor_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    const bool is_to_write = (flags & O_ACCMODE) == O_WRONLY;
    if (descriptor_ < 0) fail(path, is_to_write ? "cannot be written" : "cannot be opened", remedy);
  }
  ~OpenFile() { close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor() const { return descriptor_; }

  struct stat status() const {
    struct stat result {};
    if (fstat(descriptor_, &result) != 0) fail(path_, "cannot be read", kReadRemedy);
    return result;
  }

  std::size_t read_some(std::span<std::byte> bytes) const {
    ssize_t count = 0;
    do {
      count = ::read(descriptor_, bytes.data(), bytes.size());
    } while (count < 0 && errno == EINTR);
    if (count < 0) fail(path_, "cannot be read", kReadRemedy);
    return static_cast<std::size_t>(count);
  }

  void write_all(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno != EINTR) fail_to_write(path_);
      if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
  }

  void sync() const {
    if (fsync(descriptor_) != 0) fail_to_write(path_);
  }

 private:
  fs::path path_;
  int descriptor_;
};

bool is_special(const fs::path& path) {
  return fs::exists(path) && !fs::is_regular_file(path) && !fs::is_directory(path);
}

// The file a link stands for, so that the link survives.
fs::path target_of(const fs::path& path) {
  return fs::is_symlink(path) ? fs::weakly_canonical(path) : path;
}

void write_synced(const fs::path& path, std::span<const std::byte> bytes) {
  const OpenFile file(path, O_WRONLY | O_CREAT | O_TRUNC, kWriteRemedy);
  file.write_all(bytes);
  file.sync();
}

}  // namespace

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::vector<std::byte> read_file(const fs::path& path) {
  refuse_pipe(path);
  const OpenFile file(path, O_RDONLY, kReadRemedy);
  const struct stat status = file.status();
  if (S_ISDIR(status.st_mode)) throw InputError(path.string(), "is a folder", "name a file in it");
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const std::size_t count = file.read_some(std::span(bytes).subspan(filled));
    if (count == 0) break;  // it has become shorter meanwhile
    filled += count;
  }
  bytes.resize(filled);
  return bytes;
}

void replace_file(const fs::path& path, std::span<const std::byte> bytes) {
  if (is_special(path)) return OpenFile(path, O_WRONLY, kWriteRemedy).write_all(bytes);
  const fs::path target = target_of(path);
  fs::path unfinished = target;
  unfinished += ".unfinished";
  try {
    write_synced(unfinished, bytes);
    if (rename(unfinished.c_str(), target.c_str()) != 0) fail(path, "cannot be replaced", kWriteRemedy);
  } catch (...) {
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw;
  }
  OpenFile(folder_of(target), O_RDONLY | O_DIRECTORY, kWriteRemedy).sync();
}

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
  OpenFile(path, O_WRONLY | O_CREAT | O_TRUNC, kWriteRemedy).write_all(bytes);
}

PiecewiseFile::PiecewiseFile(const fs::path& path) : path_(path) {
  refuse_pipe(path);
  const OpenFile file(path, O_RDONLY, kReadRemedy);
  const struct stat status = file.status();
  if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "is no file", "name a file");
  size_ = static_cast<std::size_t>(status.st_size);
  descriptor_ = fcntl(file.descriptor(), F_DUPFD_CLOEXEC, 0);
  if (descriptor_ < 0) fail(path, "cannot be kept open", "close other files, or raise their limit (ulimit -n)");
}

PiecewiseFile::~PiecewiseFile() {
  close(descriptor_);
}

void PiecewiseFile::read(std::size_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path_, "cannot be read", kReadRemedy);
    if (count == 0) throw InputError(path_.string(), "has become shorter since it was opened", kChangeRemedy);
    offset += static_cast<std::size_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

MappedFile::MappedFile(const fs::path& path) {
  refuse_pipe(path);
  const OpenFile file(path, O_RDONLY, kReadRemedy);
  const struct stat status = file.status();
  if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "is no file", "name a file");
  size_ = static_cast<std::size_t>(status.st_size);
  if (size_ == 0) return;
  void* const address = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.descriptor(), 0);
  if (address == MAP_FAILED) fail(path, "cannot be mapped into memory", kReadRemedy);
  data_ = static_cast<const std::byte*>(address);
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) munmap(const_cast<std::byte*>(data_), size_);
}

}  // namespace byre
