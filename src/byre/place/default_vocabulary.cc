#include "byre/base/data_file.h"
#include "byre/input_error.h"
#include "byre/place/vocabulary.h"

#include <cstdlib>
#include <string>
#include <system_error>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileName = "default.vocabulary";
constexpr const char* kVariable = "BYRE_VOCABULARY";

}  // namespace

fs::path default_vocabulary_path() {
  if (const char* const chosen = std::getenv(kVariable); chosen != nullptr && *chosen != '\0') {
    std::error_code ignored;
    if (fs::is_regular_file(chosen, ignored)) return chosen;
    throw InputError(chosen, "is not a file", std::string("correct or unset $") + kVariable);
  }
  return find_data_file(kFileName, std::string("install byre, or give a vocabulary by $") + kVariable);
}

}  // namespace byre
