#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace byre {

// A file without a name for what is seldom looked at and shall not fill memory. What is put into it is looked at as
// memory is, and loaded page by page; a piece of it lasts as long as anybody holds on to it, and its room on the disk
// too. The file lies in the folder that the environment's TMPDIR names, else in /var/tmp, which is on a disk, else in
// /tmp.
class ScratchFile {
 public:
  ScratchFile();

  // A copy of the bytes that lies in the file, on pages of its own. Empty where no file could be made or the
  // disk is full; from then on always. By one thread at a time; others may do meanwhile whatever is const.
  std::shared_ptr<const std::byte> put(std::span<const std::byte> bytes);

  bool holds(const void* address) const;  // whether it lies in what was put in, or will be

  std::size_t bytes_on_disk() const;

  // What was looked at leaves memory until it is looked at again.
  void forget_looks() const;

 private:
  class File;
  class Stretch;

  bool make_room(std::size_t end);

  std::shared_ptr<const File> file_;       // constant after construction; empty where there is none
  std::shared_ptr<const Stretch> newest_;  // the last one; empty before the first
  std::size_t end_ = 0;                    // bytes in the file
  bool is_full_ = false;
  mutable std::mutex mutex_;                             // for what follows
  std::vector<std::weak_ptr<const Stretch>> stretches_;  // some may have gone
};

}  // namespace byre
