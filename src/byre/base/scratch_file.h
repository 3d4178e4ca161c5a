#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace byre {

// Unnamed file for rarely read data, mapped read-only and loaded page by page. A piece and its disk space last as long
// as its shared_ptr. Created in $TMPDIR, else in /var/tmp (on a disk), else in /tmp.
class ScratchFile {
 public:
  ScratchFile();

  // Copies the bytes to the file, on pages of their own. Null without a file or if the disk is full, and in all later
  // calls. Called by one thread at a time; const methods may run concurrently.
  std::shared_ptr<const std::byte> put(std::span<const std::byte> bytes);

  bool holds(const void* address) const;  // whether the address is in the mapped file

  std::size_t bytes_on_disk() const;

  // Drops mapped pages from memory until they are read again.
  void release_pages() const;

 private:
  class File;
  class Extent;

  bool extend_to(std::size_t end);

  std::shared_ptr<const File> file_;      // constant after construction; null if no file could be created
  std::shared_ptr<const Extent> newest_;  // the last stretch; null before the first
  std::size_t end_ = 0;                   // bytes in the file
  bool is_full_ = false;
  mutable std::mutex mutex_;                          // guards extents_
  std::vector<std::weak_ptr<const Extent>> extents_;  // some may have expired
};

}  // namespace byre
