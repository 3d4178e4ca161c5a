#pragma once

#include "byre/map.h"

#include <filesystem>
#include <optional>

#include <CLI/App.hpp>

namespace byre::cli {

// Picture of the changes from one version of a map to another, from above.
struct ChangesPicture {
  std::optional<std::filesystem::path> file;  // empty: none
  std::optional<std::filesystem::path> plan;  // below it; the later version must be registered
};

// Declares --picture and --plan.
void declare_changes_picture(CLI::App& command, ChangesPicture& picture);

// Removed and added points, with the keyframes of the later version. Writes nothing without a file. Throws InputError
// if the later version is not registered on the plan, or the picture cannot be written.
void write_changes(const Map& before, const Map& after, const MapDifference& difference, const std::string& title,
                   const ChangesPicture& picture);

}  // namespace byre::cli
