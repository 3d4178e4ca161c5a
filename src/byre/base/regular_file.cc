#include "byre/base/regular_file.h"

#include "byre/input_error.h"

#include <cerrno>

#include <sys/stat.h>

namespace byre {

void refuse_pipe(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    if (errno != ELOOP) return;
    throw InputError(path.string(), "is a circular link", "give a file or folder");
  }
  if (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) return;
  throw InputError(path.string(), "is a pipe or a device, not a file", "save its output to a file, and give that file");
}

}  // namespace byre
