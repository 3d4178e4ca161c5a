#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace byre {

// A file without a name for what is seldom looked at and shall not fill memory. What is put into it is looked at as
// memory is, and loaded page by page; a piece of it lasts as long as anybody holds on to it. It lies in the folder that
// the environment's TMPDIR names, else in /var/tmp, which is on a disk, else in /tmp.
class ScratchFile {
 public:
  // A copy of the bytes that lies in the file, aligned as allocated memory is. Empty where no file can be made or the
  // disk is full; from then on always. Who holds pieces may look at them meanwhile.
  std::shared_ptr<const std::byte> put(std::span<const std::byte> bytes);

  bool holds(const void* address) const;  // whether it lies in what was put in

  // What was looked at leaves memory until it is looked at again. Who holds pieces may look at them meanwhile.
  void forget_looks() const;

 private:
  class File;     // closed when it goes; its segments stay
  class Segment;  // a stretch of the file that is mapped into memory

  std::shared_ptr<File> file_;  // empty until it is needed
  std::vector<std::shared_ptr<const Segment>> segments_;
  std::size_t end_ = 0;   // bytes in the file
  std::size_t room_ = 0;  // behind that in the last segment, bytes
  bool has_failed_ = false;
};

}  // namespace byre
