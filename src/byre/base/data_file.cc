#include "byre/base/data_file.h"

#include "byre/input_error.h"

#include <cstdlib>
#include <optional>
#include <string>
#include <system_error>

#include <dlfcn.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// The file of this code: a program, or a shared object such as a Python module.
fs::path this_binary() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&this_binary), &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code ignored;
  return fs::canonical(info.dli_fname, ignored);
}

fs::path this_program() {
  std::error_code ignored;
  return fs::read_symlink("/proc/self/exe", ignored);
}

// The file in a relocated installation: its prefix is one of the folders above the binary.
std::optional<fs::path> find_above(const fs::path& binary, const fs::path& name) {
  for (fs::path folder = binary.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    const fs::path data = folder / BYRE_DATA_IN_PREFIX / name;
    if (is_file(data)) return data;
  }
  return std::nullopt;
}

}  // namespace

fs::path find_data_file(const fs::path& name, std::string_view remedy) {
  const char* const given = std::getenv("BYRE_DATA");
  if (given != nullptr && is_file(fs::path(given) / name)) return fs::path(given) / name;
  for (const fs::path& binary : {this_program(), this_binary()}) {
    if (const auto found = find_above(binary, name)) return *found;
  }
  // Packages are installed below /usr, independent of the configured prefix.
  for (const fs::path folder : {BYRE_INSTALLED_DATA, "/usr/local/share/byre", "/usr/share/byre", BYRE_SOURCE_DATA}) {
    if (is_file(folder / name)) return (folder / name).lexically_normal();
  }
  throw InputError(name.string(),
                   std::string("is not found in ") + BYRE_INSTALLED_DATA +
                       ", /usr/local/share/byre, /usr/share/byre, the source tree or the folder given by BYRE_DATA",
                   remedy);
}

}  // namespace byre
