#include "byre/input/input_error.h"
#include "byre/place/vocabulary.h"

#include <array>
#include <cstdlib>
#include <optional>
#include <system_error>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileName = "default.vocabulary";
constexpr const char* kVariable = "BYRE_VOCABULARY";

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// Where byre's data are as seen from the running program, in an installation that may have been moved.
fs::path data_beside_program() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : program.parent_path() / BYRE_DATA_FROM_PROGRAM;
}

}  // namespace

fs::path default_vocabulary_path() {
  if (const char* const chosen = std::getenv(kVariable); chosen != nullptr && *chosen != '\0') {
    if (!is_file(chosen)) throw InputError(chosen, "is no file", std::string("correct or unset $") + kVariable);
    return chosen;
  }
  for (const fs::path& folder : {data_beside_program(), fs::path(BYRE_INSTALLED_DATA), fs::path(BYRE_SOURCE_DATA)}) {
    if (is_file(folder / kFileName)) return (folder / kFileName).lexically_normal();
  }
  throw InputError(kFileName, std::string("is neither in ") + BYRE_INSTALLED_DATA + " nor in the source tree",
                   std::string("install byre, or name a vocabulary by $") + kVariable);
}

}  // namespace byre
