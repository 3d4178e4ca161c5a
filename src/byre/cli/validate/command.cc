#include "byre/base/printable.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/map/map_file.h"

#include <filesystem>
#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr const char* kValidateFooter = R"(Example:
  byre validate barn.byre && cp barn.byre /backup

Exit codes: 0 the map is sound, 1 it has faults, which are listed, 3 the file cannot be read as a map.)";

ExitCode run_validate(const std::filesystem::path& path, std::ostream& result) {
  const StoredMap stored = load_map(path);
  const std::vector<std::string> faults = find_faults(stored);
  for (const std::string& fault : faults) result << printable(path.string() + ": " + fault) << "\n";
  if (!faults.empty()) return ExitCode::failed;
  result << printable(path.string()) << ": sound, " << stored.map.keyframe_count() << " keyframes, "
         << stored.map.point_count() << " points\n";
  return ExitCode::done;
}

}  // namespace

Action declare_validate(CLI::App& command) {
  const auto path = std::make_shared<std::filesystem::path>();
  add_input(command, Input::file, "MAP", *path, "Map file of \"byre map -o\"")->required();
  command.footer(kValidateFooter);
  return [path](std::ostream& result) { return run_validate(*path, result); };
}

}  // namespace byre::cli
