#include "byre/base/binary_file.h"

#include "byre/base/regular_file.h"
#include "byre/input_error.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

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

constexpr std::string_view kReadRemedy = "check that the file exists and is readable";
constexpr std::string_view kChangeRemedy = "replace the file instead of changing it while it is in use";
// An open file, closed by the destructor.
class OpenFile {
 public:
  explicit OpenFile(const fs::path& path) : path_(path), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) fail(path, "cannot be opened", kReadRemedy);
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

 private:
  fs::path path_;
  int descriptor_;
};

}  // namespace

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::vector<std::byte> read_file(const fs::path& path) {
  refuse_pipe(path);
  const OpenFile file(path);
  const struct stat status = file.status();
  if (S_ISDIR(status.st_mode)) throw InputError(path.string(), "is a folder", "give a file in it");
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const std::size_t count = file.read_some(std::span(bytes).subspan(filled));
    if (count == 0) break;  // the file was truncated meanwhile
    filled += count;
  }
  bytes.resize(filled);
  return bytes;
}

RandomAccessFile::RandomAccessFile(const fs::path& path) : path_(path) {
  refuse_pipe(path);
  const OpenFile file(path);
  const struct stat status = file.status();
  if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "is not a regular file", "give a regular file");
  size_ = static_cast<std::size_t>(status.st_size);
  descriptor_ = fcntl(file.descriptor(), F_DUPFD_CLOEXEC, 0);
  if (descriptor_ < 0)
    fail(path, "cannot be kept open", "close other files, or raise the limit of open files (ulimit -n)");
}

RandomAccessFile::~RandomAccessFile() {
  close(descriptor_);
}

void RandomAccessFile::read(std::size_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path_, "cannot be read", kReadRemedy);
    if (count == 0) throw InputError(path_.string(), "was truncated after it was opened", kChangeRemedy);
    offset += static_cast<std::size_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

MappedFile::MappedFile(const fs::path& path) {
  refuse_pipe(path);
  const OpenFile file(path);
  const struct stat status = file.status();
  if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "is not a regular file", "give a regular file");
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
