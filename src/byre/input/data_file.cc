#include "byre/input/data_file.h"

#include "byre/input_error.h"

#include <string>
#include <system_error>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

fs::path data_beside_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : program.parent_path() / BYRE_DATA_FROM_PROGRAM;
}

}  // namespace

fs::path find_data_file(const fs::path& name, std::string_view remedy) {
  for (const fs::path& folder : {data_beside_program(), fs::path(BYRE_INSTALLED_DATA), fs::path(BYRE_SOURCE_DATA)}) {
    if (is_file(folder / name)) return (folder / name).lexically_normal();
  }
  throw InputError(name.string(), std::string("is neither in ") + BYRE_INSTALLED_DATA + " nor in the source tree",
                   remedy);
}

}  // namespace byre
