#include "byre/base/output_file.h"
#include "byre/cli/registry/commands.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/playback/report/report.h"
#include "byre/registry/plans.h"
#include "byre/registry/schema.h"
#include "byre/registry/versions.h"

#include <filesystem>
#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct PushOptions {
  std::string uri;
  std::string site;
  std::vector<fs::path> files;
  std::optional<fs::path> plan;
  std::optional<std::string> name;
  std::string note;
  bool json = false;
};

struct PullOptions {
  std::string uri;
  std::string site;
  std::optional<std::string> version;
  std::optional<fs::path> output;
  std::optional<fs::path> plan;
  std::optional<std::string> name;
  bool json = false;
};

constexpr const char* kPushFooter = R"(Examples:
  byre registry push barn barn.byre --note "mapped by day"
  byre registry push barn evening.session
  byre registry push barn --plan plan.yaml --name ground --note "new gate"

A map becomes a proposed version, for a reviewer to accept. A session of "byre run --save-session" waits for the next
update of its site by "byre worker". A file that is there already is not sent again, nor the chunks that an interrupted
push sent; the server verifies their SHA-256. A floor plan, with the image or world file that it needs, becomes the
current plan of its name; earlier ones stay.)";

constexpr const char* kPullFooter = R"(Examples:
  byre registry pull barn -o barn.byre
  byre registry pull barn --version 3f2a90cc51d07be4 -o earlier.byre
  byre registry pull barn --plan plans --name ground

Nothing is sent if MAP has this version already. MAP is replaced as a whole, after all bytes are verified. A transfer
continues after a broken connection. --plan writes the files of the current plan to FOLDER under their own names, by
which maps name their plan.)";

ExitCode run_push(const PushOptions& options, std::ostream& result) {
  Connection connection = open_registry(options.uri);
  const std::int64_t site = site_number(connection, options.site);
  Report report{{{"program", "byre registry push"}, {"site", options.site}, {"files", Json::array()}}};
  for (const fs::path& path : options.files) {
    const PushedFile file = push_file(connection, site, path, options.note);
    report.figures["files"].push_back({{"file", path.string()},
                                       {"id", file.id},
                                       {"kind", file.is_session ? "session" : "version"},
                                       {"new", file.is_new}});
    report.row(file.is_session ? "session" : "version", "{id} {file}[{!new}, as before]",
               report.figures["files"].back());
  }
  if (options.plan) {
    const PushedPlan plan = push_plan(connection, site, *options.plan, options.name, options.note);
    report.figures["files"].push_back({{"file", options.plan->string()},
                                       {"id", fmt::format("{} {}", plan.name, plan.number)},
                                       {"kind", "plan"},
                                       {"new", plan.is_new}});
    report.row("plan", "{id} {file}[{!new}, as before]", report.figures["files"].back());
  }
  result << (options.json ? to_json(report) : to_text(report, true));
  return ExitCode::done;
}

ExitCode run_pull(const PullOptions& options, std::ostream& result) {
  constexpr const char* kWritten = "{written}[{?bytes_received}: {bytes_received*1e-6:.1f} MB|, as before]";
  if (options.output) require_writable(*options.output, FileContent::map);
  Connection connection = open_registry(options.uri);
  const std::int64_t site = site_number(connection, options.site);
  Report report{{{"program", "byre registry pull"}, {"site", options.site}}};
  if (options.output) {
    const PulledMap map = pull_map(connection, site, options.version, *options.output);
    report.figures.update({{"id", map.id}, {"bytes_received", map.received}, {"written", options.output->string()}});
    report.row("version", "{id}");
    report.row("written", kWritten);
  }
  if (options.plan) {
    const RegistryPlan plan =
        find_plan(connection, site, options.name, options.output ? std::nullopt : options.version);
    const PulledPlan pulled = pull_plan(connection, site, plan, *options.plan);
    report.figures["plan"] = {{"name", plan.name},
                              {"number", plan.number},
                              {"bytes_received", pulled.received},
                              {"written", pulled.path.string()}};
    report.row("plan", "{name} {number}", report.figures["plan"]);
    report.row("written", kWritten, report.figures["plan"]);
  }
  result << (options.json ? to_json(report) : to_text(report, true));
  return ExitCode::done;
}

}  // namespace

Action declare_registry_push(CLI::App& command) {
  const auto options = std::make_shared<PushOptions>();
  add_site(command, options->site);
  add_input(command, Input::file, "FILE", options->files, "Maps and sessions")->type_name("FILE");
  CLI::Option* const plan =
      add_input(command, Input::plan, "--plan", options->plan, "Floor plan: YAML file, or image with a world file");
  plan->type_name("FILE");
  add_text(command, "--name", options->name, "Name of the plan: floor or building (name of its file)")
      ->type_name("NAME")
      ->needs(plan);
  add_text(command, "--note", options->note, "Note on the proposed versions and the plan")->type_name("TEXT");
  add_registry(command, options->uri);
  command.add_flag("--json", options->json, "Print the report as JSON");
  check_when_parsed(command, [options] {
    if (options->files.empty() && !options->plan) {
      throw CLI::ValidationError("FILE", "give maps or sessions, or a plan (--plan)");
    }
  });
  command.footer(kPushFooter);
  return [options](std::ostream& result) { return run_push(*options, result); };
}

Action declare_registry_pull(CLI::App& command) {
  const auto options = std::make_shared<PullOptions>();
  add_site(command, options->site);
  add_text(command, "--version", options->version, "Another version than the accepted one, or number of the plan")
      ->type_name("ID");
  add_output(command, Output::map, "-o,--output", options->output, "Map file")->type_name("MAP");
  CLI::Option* const plan = add_output(command, Output::folder, "--plan", options->plan, "Folder for the floor plan");
  plan->type_name("FOLDER");
  add_text(command, "--name", options->name, "Name of the plan (the only one)")->type_name("NAME")->needs(plan);
  add_registry(command, options->uri);
  command.add_flag("--json", options->json, "Print the report as JSON");
  check_when_parsed(command, [options] {
    if (!options->output && !options->plan) {
      throw CLI::ValidationError("--output", "give a map file (-o), or a folder for the plan (--plan)");
    }
  });
  command.footer(kPullFooter);
  return [options](std::ostream& result) { return run_pull(*options, result); };
}

}  // namespace byre::cli
