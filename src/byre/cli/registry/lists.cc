#include "byre/cli/registry/command.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/progress.h"
#include "byre/playback/report/report.h"
#include "byre/registry/blobs.h"
#include "byre/registry/connection.h"
#include "byre/registry/listing.h"
#include "byre/registry/versions.h"

#include <chrono>
#include <iostream>
#include <memory>
#include <ostream>
#include <thread>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ListOptions {
  std::string uri;
  std::string site;  // empty: all
  std::string version;
  bool plan = false;
  std::optional<std::string> name;  // name of a plan
  bool json = false;
  bool once = false;
};

constexpr const char* kListFooter = R"(Examples:
  byre registry list
  byre registry list barn --json

Lists what the account may read: of a site versions, the newest first, current floor plans, sessions that no accepted
version has yet, and jobs that wait, run, or were set aside.)";

constexpr const char* kShowFooter = R"(Examples:
  byre registry show barn 3f2a90cc51d07be4
  byre registry show barn --plan --name ground

Prints the versions that it was made of, its sessions, and who proposed, accepted and retired it, when and why. --plan
prints floor plans with earlier ones, the current ones first.)";

constexpr const char* kHistoryFooter = R"(Example:
  byre registry history barn --json

Prints the events of a site, the newest first: versions proposed, accepted and retired, sessions
and plans added, jobs ended.)";

constexpr const char* kWatchFooter = R"(Examples:
  byre registry watch barn
  byre registry watch barn --once && byre registry pull barn -o barn.byre

Prints the id of the accepted version, then that of each version that is accepted later, within a second. Connects again
after a broken connection. --once ends after the first version that is accepted later.)";

constexpr const char* kMetricsFooter = R"(Example:
  byre registry metrics | sponge /var/lib/prometheus/node-exporter/byre.prom

Text format of Prometheus, here for the textfile collector of its node exporter, by a timer: versions, jobs and open
sessions of each site; when each robot was seen, what it runs, and sessions that it has not sent.)";

Report sites_report(Connection& connection) {
  Report report{Json::parse(sites_json(connection))};
  for (const Json& site : report.figures) {
    report.line(
        "{site}: [accepted {accepted}|no accepted version][{?proposed}, {proposed} proposed]"
        "[{?open_sessions}, {open_sessions} open sessions][{?jobs}, {jobs} jobs]"
        "[{?failed_jobs}, {failed_jobs} jobs set aside]",
        site);
  }
  return report;
}

Report site_report(Connection& connection, const std::string& site) {
  Report report{Json::parse(site_json(connection, site_number(connection, site)))};
  for (const Json& version : report.figures["versions"]) {
    report.row(
        version["state"].get<std::string>(),
        "{id} {bytes*1e-6:.1f} MB, by {added_by} {added_at}[{?note}: {note}][{?reason} ({reviewed_by}: {reason})]",
        version);
  }
  for (const Json& plan : report.figures["plans"]) {
    report.row("plan", "{name} {number} {file}, by {added_by} {added_at}[{?note}: {note}]", plan);
  }
  for (const Json& session : report.figures["sessions"]) {
    report.row("session", "{id} {name}, ran on {ran_on}, by {added_by} {added_at}", session);
  }
  for (const Json& job : report.figures["jobs"]) {
    report.row("job",
               "{id} {kind}[{?recording} {recording}], {state}[{?attempts}, attempt {attempts}][{?message}: {message}]",
               job);
  }
  for (const Json& robot : report.figures["robots"]) {
    report.row(
        "robot",
        "{account}[{?seen_at}, seen {seen_at}|, never seen][{?runs}, runs {runs}][{?waiting}, {waiting} sessions "
        "wait][{?refused}, refuses {refused}: {reason}]",
        robot);
  }
  return report;
}

Report version_report(Connection& connection, const ListOptions& options) {
  Report report{Json::parse(version_json(connection, site_number(connection, options.site), options.version))};
  report.row("version", "{id}, {state}, {bytes*1e-6:.1f} MB");
  report.row("note", "{?note}{note}");
  report.row("made of", "{?parents}{parents}");
  for (const Json& session : report.figures["sessions"]) {
    report.row("session", "{id} {name}, ran on {ran_on}, by {added_by}", session);
  }
  for (const Json& event : report.figures["events"]) {
    report.row(event["kind"].get<std::string>(), "{at} by {actor}[{?reason}: {reason}]", event);
  }
  return report;
}

Report plans_report(Connection& connection, const ListOptions& options) {
  const std::int64_t site = site_number(connection, options.site);
  Report report{Json::parse(plans_json(connection, site, options.name))};
  if (report.figures.empty()) find_plan(connection, site, options.name, {});  // reports that there is none
  for (const Json& plan : report.figures) {
    report.row(
        "plan",
        "{name} {number} {file} with {other_file}, {bytes*1e-6:.1f} MB, by {added_by} {added_at}[{?note}: {note}]",
        plan);
  }
  return report;
}

Report events_report(Connection& connection, const std::string& site) {
  Report report{Json::parse(events_json(connection, site_number(connection, site)))};
  for (const Json& event : report.figures) {
    report.line("{at} {kind} {subject} by {actor}[{?reason}: {reason}]", event);
  }
  return report;
}

ExitCode print(const Report& report, const ListOptions& options, std::ostream& result) {
  result << (options.json ? to_json(report) : to_text(report, true));
  return ExitCode::done;
}

ExitCode run_watch(const ListOptions& options, std::ostream& result) {
  const InterruptCatcher interrupt;
  Connection connection = open_registry(options.uri);
  const std::int64_t site = site_number(connection, options.site);
  std::optional<std::string> seen;
  bool is_first = true, is_broken = false;
  while (!interrupt.caught()) {
    try {
      if (is_broken) connection.reconnect();
      if (is_broken || is_first) connection.run("LISTEN byre_accepted");
      is_broken = false;
      const std::optional<std::string> accepted = accepted_version(connection, site);
      if (accepted && accepted != seen) {
        result << (options.json ? dump_json({{"site", options.site}, {"accepted", *accepted}}) : *accepted)
               << std::endl;
        if (options.once && !is_first) return ExitCode::done;
      }
      seen = accepted;
      is_first = false;
      while (!interrupt.caught() && !connection.wait_for_notification(std::chrono::seconds(1))) {
      }
    } catch (const ConnectionLost& lost) {
      if (is_first) throw;
      if (!is_broken) show_warnings(std::cerr, {lost.what()});
      is_broken = true;
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
  }
  return ExitCode::interrupted;
}

// Options that the subcommands here share.
std::shared_ptr<ListOptions> declare_list(CLI::App& command, const char* footer) {
  auto options = std::make_shared<ListOptions>();
  add_registry(command, options->uri);
  command.add_flag("--json", options->json, "Print JSON");
  command.footer(footer);
  return options;
}

}  // namespace

Action declare_registry_list(CLI::App& command) {
  const auto options = declare_list(command, kListFooter);
  add_text(command, "SITE", options->site, "Name of a site (all)")->type_name("SITE");
  return [options](std::ostream& result) {
    Connection connection = open_registry(options->uri);
    return print(options->site.empty() ? sites_report(connection) : site_report(connection, options->site), *options,
                 result);
  };
}

Action declare_registry_show(CLI::App& command) {
  const auto options = declare_list(command, kShowFooter);
  add_site(command, options->site);
  CLI::Option* const version = add_version_id(command, options->version)->required(false);
  CLI::Option* const plan = command.add_flag("--plan", options->plan, "Floor plans instead of a version");
  add_text(command, "--name", options->name, "Name of the plan (all)")->type_name("NAME")->needs(plan);
  check_when_parsed(command, [options, version] {
    if (options->plan == (version->count() > 0)) throw CLI::ValidationError("VERSION", "give a version, or --plan");
  });
  return [options](std::ostream& result) {
    Connection connection = open_registry(options->uri);
    return print(options->plan ? plans_report(connection, *options) : version_report(connection, *options), *options,
                 result);
  };
}

Action declare_registry_history(CLI::App& command) {
  const auto options = declare_list(command, kHistoryFooter);
  add_site(command, options->site);
  return [options](std::ostream& result) {
    Connection connection = open_registry(options->uri);
    return print(events_report(connection, options->site), *options, result);
  };
}

Action declare_registry_metrics(CLI::App& command) {
  const auto uri = std::make_shared<std::string>();
  add_registry(command, *uri);
  command.footer(kMetricsFooter);
  return [uri](std::ostream& result) {
    Connection connection = open_registry(*uri);
    result << registry_metrics(connection);
    return ExitCode::done;
  };
}

Action declare_registry_watch(CLI::App& command) {
  const auto options = declare_list(command, kWatchFooter);
  add_site(command, options->site);
  command.add_flag("--once", options->once, "End after the first version that is accepted later");
  return [options](std::ostream& result) { return run_watch(*options, result); };
}

}  // namespace byre::cli
