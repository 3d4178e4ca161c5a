#include "byre/base/output_file.h"
#include "byre/cli/registry/commands.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/playback/report/report.h"
#include "byre/registry/schema.h"
#include "byre/registry/versions.h"

#include <filesystem>
#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct PushOptions {
  std::string uri;
  std::string site;
  std::vector<fs::path> files;
  std::string note;
  bool json = false;
};

struct PullOptions {
  std::string uri;
  std::string site;
  std::optional<std::string> version;
  fs::path output;
  bool json = false;
};

constexpr const char* kPushFooter = R"(Examples:
  byre registry push barn barn.byre --note "mapped by day"
  byre registry push barn evening.session

A map becomes a proposed version, for a reviewer to accept. A session of "byre run --save-session" waits for the next
update of its site by "byre worker". A file that is there already is not sent again, nor the chunks that an interrupted
push sent; the server verifies their SHA-256.)";

constexpr const char* kPullFooter = R"(Examples:
  byre registry pull barn -o barn.byre
  byre registry pull barn --version 3f2a90cc51d07be4 -o earlier.byre

Nothing is sent if MAP has this version already. MAP is replaced as a whole, after all bytes are verified. A transfer
continues after a broken connection.)";

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
  result << (options.json ? to_json(report) : to_text(report, true));
  return ExitCode::done;
}

ExitCode run_pull(const PullOptions& options, std::ostream& result) {
  require_writable(options.output, FileContent::map);
  Connection connection = open_registry(options.uri);
  const PulledMap map = pull_map(connection, site_number(connection, options.site), options.version, options.output);
  Report report{{{"program", "byre registry pull"},
                 {"site", options.site},
                 {"id", map.id},
                 {"bytes_received", map.received},
                 {"written", options.output.string()}}};
  report.row("version", "{id}");
  report.row("written", "{written}[{?bytes_received}: {bytes_received*1e-6:.1f} MB|, as before]");
  result << (options.json ? to_json(report) : to_text(report, true));
  return ExitCode::done;
}

}  // namespace

Action declare_registry_push(CLI::App& command) {
  const auto options = std::make_shared<PushOptions>();
  add_site(command, options->site);
  add_input(command, Input::file, "FILE", options->files, "Maps and sessions")->type_name("FILE")->required();
  add_text(command, "--note", options->note, "Note on the proposed versions")->type_name("TEXT");
  add_registry(command, options->uri);
  command.add_flag("--json", options->json, "Print the report as JSON");
  command.footer(kPushFooter);
  return [options](std::ostream& result) { return run_push(*options, result); };
}

Action declare_registry_pull(CLI::App& command) {
  const auto options = std::make_shared<PullOptions>();
  add_site(command, options->site);
  add_text(command, "--version", options->version, "Another version than the accepted one")->type_name("ID");
  add_output(command, Output::map, "-o,--output", options->output, "Map file")->type_name("MAP")->required();
  add_registry(command, options->uri);
  command.add_flag("--json", options->json, "Print the report as JSON");
  command.footer(kPullFooter);
  return [options](std::ostream& result) { return run_pull(*options, result); };
}

}  // namespace byre::cli
