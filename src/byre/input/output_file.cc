#include "byre/input/output_file.h"

#include "byre/input/binary_file.h"
#include "byre/input_error.h"

#include <span>
#include <system_error>

#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// A device, a pipe, or a link, which may stand for one: renaming would put a file in its place.
bool is_written_in_place(const fs::path& path) {
  return fs::is_symlink(path) || (fs::exists(path) && !fs::is_regular_file(path));
}

void require_access(const fs::path& path) {
  if (access(path.c_str(), W_OK) == 0) return;
  throw InputError(path.string(), "may not be written", "check its permissions");
}

void write_text(const std::string& text, const fs::path& path) {
  write_file(path, std::as_bytes(std::span(text)));
}

}  // namespace

void require_writable(const fs::path& path) {
  if (path.filename().empty() || fs::is_directory(path)) {
    throw InputError(path.string(), "is a folder", "name a file in it");
  }
  if (is_written_in_place(path)) return require_access(path);
  const fs::path folder = folder_of(path);
  if (!fs::is_directory(folder)) {
    throw InputError(path.string(), "cannot be written: its folder does not exist",
                     "make the folder " + folder.string());
  }
  require_access(folder);
}

void write_whole(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  if (is_written_in_place(path)) return write(path);
  fs::path unfinished = path;
  unfinished += ".unfinished";
  try {
    write(unfinished);
    fs::rename(unfinished, path);
  } catch (...) {
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw;
  }
}

void write_whole(const fs::path& path, const std::string& text) {
  write_whole(path, [&text](const fs::path& unfinished) { write_text(text, unfinished); });
}

}  // namespace byre
