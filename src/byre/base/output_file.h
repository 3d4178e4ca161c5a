#pragma once

#include "byre/base/file_content.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace byre {

// All files of byre are written by this header. Permitted are:
//   - a new file in an existing folder that is not below /dev (except /dev/shm), /proc or /sys
//   - the replacement of an empty file, or of one with the same kind of content (may_replace), unless write-protected
//   - a link, if its target is permitted; the link stays
//   - /dev/stdout, /dev/stderr, /dev/fd/N, character devices and pipes, but not through a link; written directly
// All else is refused. A file is written under a temporary name in the same folder, NAME.xxxxxxxx.unfinished, which is
// created exclusively (O_EXCL). Then it is synced and renamed, and its folder is synced. So the path holds the whole
// old file or the whole new one, whenever the program or the machine stops.

// Throws InputError if no file with this content may be written there. For a check before the work; content: empty for
// a check of the place alone.
void require_writable(const std::filesystem::path& path, std::optional<FileContent> content = {});

enum class Durability : std::uint8_t {
  synced,
  unsynced,  // not synced; for one of many files, such as images of a recording
};

// Writes a file as a whole. Throws InputError on failure; the path is then unchanged.
void write_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes,
                      Durability durability = Durability::synced);
void write_atomically(const std::filesystem::path& path, std::string_view text);

// A file that is written piece by piece. All functions throw InputError on failure.
class OutputFile {
 public:
  OutputFile(const std::filesystem::path& path, FileContent content, Durability durability = Durability::synced);
  ~OutputFile();  // removes the temporary file unless published or kept
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // Path of the temporary file, for libraries that write by name; of a video with the extension of the path. Empty once
  // published, and if written directly.
  const std::filesystem::path& temporary() const { return temporary_; }

  // Whether the temporary file is left if writing ends here, for read_leftover(). The next file with this path removes
  // it.
  void keep_unpublished(bool is_kept);
  void append(std::span<const std::byte> bytes);
  void append(std::string_view text);
  void sync();
  // Renames the temporary file to its path. Call once; before the first append for a file that others read as it grows.
  void publish();

 private:
  std::filesystem::path path_;       // path as given
  std::filesystem::path target_;     // target of a link, else the path
  std::filesystem::path temporary_;  // empty once published, and if written directly
  Durability durability_;
  bool is_direct_ = false;  // device or pipe
  bool replaces_ = false;   // whether there was a file before
  bool is_kept_ = false;
  int descriptor_ = -1;
  int pending_ = -1;  // index in the list of unpublished files; -1: not in it
};

// Content of the temporary file that an interrupted writer kept for this path; empty without one.
std::vector<std::byte> read_leftover(const std::filesystem::path& path, FileContent content);

// Keeps the content of a file under a second path, by a hard link if the file system has them, else by a copy. Replaces
// that path as write_atomically does.
void link_or_copy(const std::filesystem::path& file, const std::filesystem::path& path);

// Removes all temporary files of this process. Safe in a signal handler that ends the program.
void remove_unpublished_files() noexcept;

// The target of a path, with links resolved; it need not exist.
std::filesystem::path target_of(std::filesystem::path path);

}  // namespace byre
