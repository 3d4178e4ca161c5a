#include "byre/base/printable.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/slam/upkeep/update_map.h"

#include <filesystem>
#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr const char* kHistoryFooter = R"(Example:
  byre history barn_3.byre

Prints the id of the map, then a line for each update, the newest first: the id of the map that was updated, sessions,
changes and the version of byre. An id is the content hash of a map file. To go back, use the file of a parent.)";

ExitCode run_history(const std::filesystem::path& path, std::ostream& result) {
  const StoredMap stored = open_map(path);
  result << to_text(map_id(path)) << " " << printable(path.string()) << "\n";
  for (const MapHistory& entry : history_of(stored)) {
    result << to_text(entry.parent) << " " << printable(entry.change) << "\n";
  }
  return ExitCode::done;
}

}  // namespace

Action declare_history(CLI::App& command) {
  const auto path = std::make_shared<std::filesystem::path>();
  add_input(command, Input::file, "MAP", *path, "Map file of \"byre update\"")->required();
  command.footer(kHistoryFooter);
  return [path](std::ostream& result) { return run_history(*path, result); };
}

}  // namespace byre::cli
