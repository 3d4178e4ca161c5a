#pragma once

#include "byre/input/file_content.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace byre {

// The way all files of byre are written. What may be written where:
//   - a new file, in a folder that exists, but not below /dev, /proc and /sys
//   - in place of an empty file or one of the same content (may_replace) that is not write-protected
//   - through a link, under these rules for what it leads to; the link stays
//   - /dev/stdout, /dev/stderr, /dev/fd/N, character devices and pipes, named by themselves: written directly
// All else is refused. A file is written under a temporary name, NAME.xxxxxxxx.unfinished, in the same folder, which no
// other file can have (O_EXCL). Then it is synced, renamed, and its folder synced. So the path holds the old file or
// the new one, whole, whenever the program or the machine stops.

// Throws InputError if no such file may be written there, for a check before the work.
void require_writable(const std::filesystem::path& path, std::optional<FileContent> content = {});

enum class Durability : std::uint8_t {
  synced,
  left_to_system,  // for many files that are of use together, such as images of a recording
};

// Writes the whole file. Throws InputError, and leaves the path as it was, if that fails.
void write_whole(const std::filesystem::path& path, std::span<const std::byte> bytes,
                 Durability durability = Durability::synced);
void write_whole(const std::filesystem::path& path, std::string_view text);

// A file that is written piece by piece. All throw InputError on failure.
class OutputFile {
 public:
  OutputFile(const std::filesystem::path& path, FileContent content, Durability durability = Durability::synced);
  ~OutputFile();  // removes a file that was not published
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Where it is written until it is published; has the extension of the path. For libraries that write by name.
  const std::filesystem::path& temporary() const { return temporary_; }

  void append(std::span<const std::byte> bytes);
  void append(std::string_view text);
  void sync();
  // Gives it its name. Once; before the first append for a file that others read as it grows.
  void publish();

 private:
  std::filesystem::path path_;       // as given
  std::filesystem::path target_;     // where a link leads, else the path
  std::filesystem::path temporary_;  // empty when published, and when written directly
  Durability durability_;
  bool is_direct_ = false;  // device or pipe
  bool replaces_ = false;   // there is a file already
  int descriptor_ = -1;
  int pending_ = -1;  // place in the list of unpublished files, or -1
};

// Gives the content of a file to a second path, by a hard link where the file system has them, else by a copy. The
// content of that path before is replaced as by write_whole.
void keep_as(const std::filesystem::path& file, const std::filesystem::path& path);

// Removes all temporary files of this process. May be called by a signal handler that ends the program.
void remove_unpublished_files() noexcept;

// The file that a path leads to by links, whether it exists or not.
std::filesystem::path target_of(std::filesystem::path path);

}  // namespace byre
