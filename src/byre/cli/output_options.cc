#include "byre/cli/output_options.h"

#include <set>

#include <CLI/CLI.hpp>

namespace byre::cli {

namespace fs = std::filesystem;

void require_distinct(const std::vector<fs::path>& outputs) {
  std::set<fs::path> files;
  for (const fs::path& file : outputs) {
    if (!files.insert(fs::absolute(file).lexically_normal()).second) {
      throw CLI::ValidationError(file.string(), "is named for two outputs");
    }
  }
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  return fs::weakly_canonical(fs::absolute(a)) == fs::weakly_canonical(fs::absolute(b));
}

std::vector<std::string> names_of(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.string());
  return names;
}

}  // namespace byre::cli
