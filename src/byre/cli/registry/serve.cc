#include "byre/cli/registry/commands.h"
#include "byre/cli/registry/review_site.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/view_options.h"
#include "byre/cli/shared/view_run.h"
#include "byre/cli/shared/warnings.h"
#include "byre/registry/listing.h"
#include "byre/registry/schema.h"
#include "byre/slam/system/resources.h"

#include <chrono>
#include <iostream>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct ServeOptions {
  std::string uri;
  ViewOptions view;
};

constexpr auto kPollPeriod = std::chrono::seconds(1);  // bound of the delay of changes without a notification

constexpr const char* kServeFooter = R"(Example:
  byre registry serve --registry postgresql://ann@db.example.org/byre

Shows sites, versions, sessions, jobs and robots in a browser, at the address printed on the standard error stream,
until Ctrl-C: for each version its map, its changes since its parent, and its history. A reviewer accepts, rejects and
rolls back versions there, each with a reason. The page has the rights of the account of --registry, for all users of
this computer; with --bind, for all who have the token.)";

// Wakes the server after each change in the registry, and when the connection breaks or is back.
void watch(Connection& connection, WebServer& server, const InterruptCatcher& interrupt) {
  std::string seen;
  bool is_listening = false, is_broken = false;
  while (!interrupt.caught()) {
    try {
      if (is_broken) connection.reconnect();
      if (!is_listening) {
        connection.run("LISTEN byre_accepted");
        connection.run("LISTEN byre_job");
      }
      const std::string key = listing_key(connection);
      if (key != seen || is_broken) server.wake();
      seen = key;
      is_listening = true;
      is_broken = false;
      connection.wait_for_notification(kPollPeriod);
    } catch (const ConnectionLost& lost) {
      if (!is_broken) {
        show_warnings(std::cerr, {lost.what()});
        server.wake();
      }
      is_listening = false;
      is_broken = true;
      std::this_thread::sleep_for(kPollPeriod);
    }
  }
}

ExitCode run_serve(const ServeOptions& options) {
  const InterruptCatcher interrupt;
  ReviewSiteOptions site{options.uri, {}};
  if (options.view.plan) site.plan = read_floor_plan(*options.view.plan);
  Connection watched = open_registry(options.uri, kPatience);
  raise_descriptor_limit();
  WebServer server(options.view.server, std::make_unique<ReviewSite>(std::move(site)));
  announce(server.urls());
  watch(watched, server, interrupt);
  return ExitCode::done;
}

}  // namespace

Action declare_registry_serve(CLI::App& command) {
  const auto options = std::make_shared<ServeOptions>();
  add_registry(command, options->uri);
  declare_viewer_options(
      command, options->view,
      "Floor plan, shown with versions that are registered on it, instead of the current plans of the registry");
  command.footer(kServeFooter);
  return [options](std::ostream&) { return run_serve(*options); };
}

}  // namespace byre::cli
