#include "byre/input/scratch_file.h"

#include <cerrno>
#include <cstdlib>
#include <functional>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace byre {
namespace {

// Bytes of addresses, not of memory or disk: where all that is ever put in will lie.
constexpr std::size_t kMost = std::size_t{64} << 30;
constexpr std::size_t kPage = 4096;  // bytes; each piece begins on a page, so that its pages are its own

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
  for (const char* const folder : {static_cast<const char*>(std::getenv("TMPDIR")), "/var/tmp", "/tmp"}) {
    const int descriptor = folder != nullptr ? open_unnamed_in(folder) : -1;
    if (descriptor >= 0) return descriptor;
  }
  return -1;
}

}  // namespace

// The open file, and the addresses at which it is looked at.
class ScratchFile::Mapping {
 public:
  // Empty where there can be none.
  static std::shared_ptr<const Mapping> make() {
    const int descriptor = open_unnamed();
    if (descriptor < 0) return nullptr;
    void* const address = mmap(nullptr, kMost, PROT_READ, MAP_SHARED | MAP_NORESERVE, descriptor, 0);
    if (address != MAP_FAILED) return std::make_shared<const Mapping>(descriptor, address);
    close(descriptor);
    return nullptr;
  }

  Mapping(int descriptor, void* address) : descriptor_(descriptor), address_(address) {}
  ~Mapping() {
    munmap(address_, kMost);
    close(descriptor_);
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;

  const std::byte* at(std::size_t offset) const { return static_cast<const std::byte*>(address_) + offset; }
  void forget_looks() const { madvise(address_, kMost, MADV_DONTNEED); }

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

  // Gives whole pages back to the disk, where the file system can.
  void give_back(std::size_t begin, std::size_t end) const {
    fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(begin),
              static_cast<off_t>(end - begin));
  }

  std::size_t bytes_on_disk() const {
    constexpr std::size_t kBlock = 512;  // bytes
    struct stat status {};
    return fstat(descriptor_, &status) == 0 ? kBlock * static_cast<std::size_t>(status.st_blocks) : 0;
  }

 private:
  int descriptor_;
  void* address_;
};

ScratchFile::ScratchFile() : mapping_(Mapping::make()) {}

std::shared_ptr<const std::byte> ScratchFile::put(std::span<const std::byte> bytes) {
  if (!mapping_ || is_full_) return nullptr;
  is_full_ = bytes.size() > kMost - end_ || !mapping_->write(bytes, end_);
  if (is_full_) return nullptr;
  const std::size_t begin = end_;
  end_ = (begin + bytes.size() + kPage - 1) / kPage * kPage;
  return {mapping_->at(begin),
          [mapping = mapping_, begin, end = end_](const void*) { mapping->give_back(begin, end); }};
}

bool ScratchFile::holds(const void* address) const {
  const auto* const byte = static_cast<const std::byte*>(address);
  return mapping_ && !std::less<>{}(byte, mapping_->at(0)) && std::less<>{}(byte, mapping_->at(kMost));
}

std::size_t ScratchFile::bytes_on_disk() const {
  return mapping_ ? mapping_->bytes_on_disk() : 0;
}

void ScratchFile::forget_looks() const {
  if (mapping_) mapping_->forget_looks();
}

}  // namespace byre
