#include "byre/base/scratch_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace byre {
namespace {

// Bytes of address space mapped at a time, not memory or disk. Mapped in steps, because address space may be limited
// (ulimit -v) and emulators keep a record of each page.
constexpr std::size_t kStretch = std::size_t{64} << 20;
constexpr std::size_t kPage = 4096;  // bytes; pieces start on a page boundary, so that no two share a page

// File descriptor, or -1.
int open_unnamed_in(const char* folder) {
  const int unnamed = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (unnamed >= 0) return unnamed;
  std::string name = std::string(folder) + "/byre-XXXXXX";  // for file systems without O_TMPFILE
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

int open_unnamed() {
  for (const char* const folder : {static_cast<const char*>(std::getenv("TMPDIR")), "/var/tmp", "/tmp"}) {
    const int descriptor = folder != nullptr ? open_unnamed_in(folder) : -1;
    if (descriptor >= 0) return descriptor;
  }
  return -1;
}

}  // namespace

class ScratchFile::File {
 public:
  // Null if no file can be created.
  static std::shared_ptr<const File> make() {
    const int descriptor = open_unnamed();
    return descriptor < 0 ? nullptr : std::make_shared<const File>(descriptor);
  }

  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() { close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  int descriptor() const { return descriptor_; }

  bool write(std::span<const std::byte> bytes, std::size_t offset) const {
    while (!bytes.empty()) {
      const ssize_t count = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      offset += static_cast<std::size_t>(count);
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    return true;
  }

  // Returns whole pages to the disk, if the file system supports it.
  void give_back(std::size_t begin, std::size_t end) const {
    fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(begin),
              static_cast<off_t>(end - begin));
  }

  std::size_t bytes_on_disk() const {
    constexpr std::size_t kBlock = 512;  // bytes; unit of st_blocks
    struct stat status {};
    return fstat(descriptor_, &status) == 0 ? kBlock * static_cast<std::size_t>(status.st_blocks) : 0;
  }

 private:
  int descriptor_;
};

// A mapped part of the file; mapped for as long as a piece of it is held.
class ScratchFile::Extent {
 public:
  // Null without free address space.
  static std::shared_ptr<const Extent> make(std::shared_ptr<const File> file, std::size_t begin, std::size_t size) {
    void* const address =
        mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_NORESERVE, file->descriptor(), static_cast<off_t>(begin));
    if (address == MAP_FAILED) return nullptr;
    munlock(address, size);  // undoes mlockall(), which would lock these pages
    return std::make_shared<const Extent>(std::move(file), begin, std::span(static_cast<std::byte*>(address), size));
  }

  Extent(std::shared_ptr<const File> file, std::size_t begin, std::span<std::byte> bytes)
      : file_(std::move(file)), begin_(begin), bytes_(bytes) {}
  ~Extent() { munmap(bytes_.data(), bytes_.size()); }
  Extent(const Extent&) = delete;
  Extent& operator=(const Extent&) = delete;

  std::size_t end() const { return begin_ + bytes_.size(); }
  const std::byte* at(std::size_t offset) const { return bytes_.data() + (offset - begin_); }
  void release_pages() const { madvise(bytes_.data(), bytes_.size(), MADV_DONTNEED); }
  void give_back(std::size_t begin, std::size_t end) const { file_->give_back(begin, end); }

  bool holds(const std::byte* byte) const {
    return !std::less<>{}(byte, bytes_.data()) && std::less<>{}(byte, bytes_.data() + bytes_.size());
  }

 private:
  std::shared_ptr<const File> file_;
  std::size_t begin_;  // bytes, offset in the file
  std::span<std::byte> bytes_;
};

ScratchFile::ScratchFile() : file_(File::make()) {}

std::shared_ptr<const std::byte> ScratchFile::put(std::span<const std::byte> bytes) {
  if (!file_ || is_full_) return nullptr;
  const std::size_t begin = end_;
  const std::size_t end = (begin + bytes.size() + kPage - 1) / kPage * kPage;
  is_full_ = !extend_to(end) || !file_->write(bytes, begin);
  if (is_full_) return nullptr;
  end_ = end;
  return {newest_->at(begin), [extent = newest_, begin, end](const void*) { extent->give_back(begin, end); }};
}

// Makes newest_ cover the range from end_ to end.
bool ScratchFile::extend_to(std::size_t end) {
  if (newest_ && end <= newest_->end()) return true;
  newest_ = Extent::make(file_, end_, std::max(kStretch, end - end_));
  const std::lock_guard lock(mutex_);
  std::erase_if(extents_, [](const auto& extent) { return extent.expired(); });
  extents_.push_back(newest_);
  return newest_ != nullptr;
}

bool ScratchFile::holds(const void* address) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(extents_, [byte = static_cast<const std::byte*>(address)](const auto& held) {
    const auto extent = held.lock();
    return extent && extent->holds(byte);
  });
}

std::size_t ScratchFile::bytes_on_disk() const {
  return file_ ? file_->bytes_on_disk() : 0;
}

void ScratchFile::release_pages() const {
  const std::lock_guard lock(mutex_);
  for (const auto& held : extents_) {
    if (const auto extent = held.lock()) extent->release_pages();
  }
}

}  // namespace byre
