#pragma once

#include "byre/viewer/web/web_server.h"

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace byre::cli {

// Options of the viewer.
struct ViewOptions {
  bool is_wanted = false;
  WebServerOptions server;
  std::optional<std::filesystem::path> plan;
  std::optional<double> stay_s;  // time after a run; infinity: until Ctrl-C; empty: infinity with a terminal, else 0
};

// The options must outlive the parsing of the command line.

// --view [PORT], --view-for, --bind and --plan of a command with a run.
void declare_run_viewer_options(CLI::App& command, ViewOptions& options);

// --port, --bind and --plan of a command without a run. plan: description of the plan.
void declare_viewer_options(CLI::App& command, ViewOptions& options, const std::string& plan);

}  // namespace byre::cli
