#pragma once

#include "byre/viewer/web_server.h"

#include <filesystem>
#include <optional>

namespace CLI {
class App;
}

namespace byre::cli {

// How a command takes the viewer.
struct ViewOptions {
  bool is_wanted = false;
  WebServerOptions server;
  std::optional<std::filesystem::path> plan;
  std::optional<double> stay_s;  // after a run, infinite: until Ctrl-C; else that with a terminal, and 0 without one
};

// For each: the options must outlive the parsing of the command line.

// --view [PORT], --view-for, --bind and --plan: for a command that may be watched.
void declare_watching(CLI::App& command, ViewOptions& options);

// --port, --bind and --plan: for the command that is there to view.
void declare_viewing(CLI::App& command, ViewOptions& options);

}  // namespace byre::cli
