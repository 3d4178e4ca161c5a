#include "byre/input/scratch_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <functional>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace byre {
namespace {

constexpr std::size_t kSegment = std::size_t{16} << 20;  // bytes
constexpr std::size_t kAlignment = alignof(std::max_align_t);

std::size_t rounded_up(std::size_t size, std::size_t unit) {
  return (size + unit - 1) / unit * unit;
}

// A descriptor, or -1.
int open_unnamed_in(const char* folder) {
  const int unnamed = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (unnamed >= 0) return unnamed;
  std::string name = std::string(folder) + "/byre-XXXXXX";  // for file systems that know no files without a name
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

int open_unnamed() {
  const char* const told = std::getenv("TMPDIR");
  for (const char* const folder : {told, "/var/tmp", "/tmp"}) {
    const int descriptor = folder != nullptr ? open_unnamed_in(folder) : -1;
    if (descriptor >= 0) return descriptor;
  }
  return -1;
}

}  // namespace

class ScratchFile::File {
 public:
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

 private:
  int descriptor_;
};

class ScratchFile::Segment {
 public:
  // Empty where it cannot be mapped.
  static std::shared_ptr<const Segment> of(const File& file, std::size_t begin, std::size_t size) {
    if (ftruncate(file.descriptor(), static_cast<off_t>(begin + size)) != 0) return nullptr;
    void* const address = mmap(nullptr, size, PROT_READ, MAP_SHARED, file.descriptor(), static_cast<off_t>(begin));
    if (address == MAP_FAILED) return nullptr;
    return std::make_shared<const Segment>(begin, size, address);
  }

  Segment(std::size_t begin, std::size_t size, void* address) : begin_(begin), size_(size), address_(address) {}
  ~Segment() { munmap(address_, size_); }
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  // offset: in the file.
  const std::byte* at(std::size_t offset) const { return static_cast<const std::byte*>(address_) + (offset - begin_); }
  bool holds(const void* address) const {
    const auto* const byte = static_cast<const std::byte*>(address);
    const auto* const first = static_cast<const std::byte*>(address_);
    return !std::less<>{}(byte, first) && std::less<>{}(byte, first + size_);
  }
  void forget_looks() const { madvise(address_, size_, MADV_DONTNEED); }

 private:
  std::size_t begin_;
  std::size_t size_;
  void* address_;
};

std::shared_ptr<const std::byte> ScratchFile::put(std::span<const std::byte> bytes) {
  if (has_failed_) return nullptr;
  has_failed_ = true;  // until it has come to its end
  if (!file_) {
    const int descriptor = open_unnamed();
    if (descriptor < 0) return nullptr;
    file_ = std::make_shared<File>(descriptor);
  }
  const std::size_t size = rounded_up(bytes.size(), kAlignment);
  if (size > room_ || segments_.empty()) {
    const std::size_t begin = end_ + room_;
    const std::size_t needed = rounded_up(std::max(size, kSegment), kSegment);
    auto segment = Segment::of(*file_, begin, needed);
    if (!segment) return nullptr;
    segments_.push_back(std::move(segment));
    end_ = begin;
    room_ = needed;
  }
  if (!file_->write(bytes, end_)) return nullptr;
  const std::size_t begin = end_;
  end_ += size;
  room_ -= size;
  has_failed_ = false;
  return {segments_.back(), segments_.back()->at(begin)};
}

bool ScratchFile::holds(const void* address) const {
  return std::ranges::any_of(segments_, [&](const auto& segment) { return segment->holds(address); });
}

void ScratchFile::forget_looks() const {
  for (const auto& segment : segments_) segment->forget_looks();
}

}  // namespace byre
