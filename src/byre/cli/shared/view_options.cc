#include "byre/cli/shared/view_options.h"

#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/number_check.h"

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

CLI::Option* declare_port(CLI::App& command, const std::string& name, int& port, const std::string& what) {
  return command.add_option(name, port, what + " (" + std::to_string(port) + "; 0: any free port)")
      ->type_name("PORT")
      ->check(between(0, 65535));
}

CLI::Option* declare_address(CLI::App& command, ViewOptions& options) {
  return add_text(command, "--bind", options.server.address,
                  "Network address to serve at, 0.0.0.0 for all; clients need the token in the printed address "
                  "(127.0.0.1: only this machine, no token)")
      ->type_name("ADDRESS");
}

CLI::Option* declare_plan(CLI::App& command, ViewOptions& options, const std::string& what) {
  return add_input(command, Input::plan, "--plan", options.plan, what)->type_name("FILE");
}

}  // namespace

void declare_run_viewer_options(CLI::App& command, ViewOptions& options) {
  CLI::Option* const view =
      declare_port(command, "--view", options.server.port, "Show the run in a browser, served at this port")
          ->expected(0, 1)
          ->default_str(std::to_string(options.server.port));
  view->each([&options](const std::string&) { options.is_wanted = true; });
  command
      .add_option("--view-for", options.stay_s,
                  "Time to serve the page after the end of the run (until Ctrl-C with a terminal, else 0)")
      ->type_name("SECONDS")
      ->check(between(0.0, 1e9))
      ->needs(view);
  declare_address(command, options)->needs(view);
  declare_plan(command, options,
               "Floor plan on which \"byre register\" registered the map: poses behind its walls are rejected, and "
               "--view shows it below the map");
}

void declare_viewer_options(CLI::App& command, ViewOptions& options, const std::string& plan) {
  options.is_wanted = true;
  declare_port(command, "--port", options.server.port, "Port to serve the page at");
  declare_address(command, options);
  declare_plan(command, options, plan + ": a map_server YAML file, or an image with a world file");
}

}  // namespace byre::cli
