#pragma once

#include "byre/cli/map_run.h"

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>

namespace byre::cli {

// The command line of "byre map".
struct MapOptions {
  std::filesystem::path recording;
  std::filesystem::path trajectory;
  std::optional<std::filesystem::path> causal_trajectory;
  std::optional<std::filesystem::path> stats;
  FrameRange range;
  Pace pace = Pace::paced;
  Refinement refinement = Refinement::all;
  bool quiet = false;

  std::vector<std::filesystem::path> outputs() const;  // those asked for
};

// The options must outlive the parsing of the command line.
void declare_map_options(CLI::App& command, MapOptions& options);

// "FIRST:END", END exclusive; either may be left out. Empty for anything else, and for a range without a frame.
std::optional<FrameRange> parse_frames(std::string_view text);

}  // namespace byre::cli
