#include "byre/cli/registry/command.h"

#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/cli/shared/arguments.h"
#include "byre/playback/report/report.h"
#include "byre/registry/blobs.h"
#include "byre/registry/versions.h"
#include "byre/slam/upkeep/place_budget.h"

#include <filesystem>
#include <memory>
#include <ostream>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace byre::cli {
namespace {

struct InitOptions {
  std::string uri;
  std::vector<std::string> sites;
};

struct AdmitOptions {
  std::string uri;
  std::string account;
  std::string role;
  std::optional<std::string> site;
};

constexpr const char* kInitFooter = R"(Examples:
  byre registry init barn annex --registry postgresql://admin@db.example.org/byre
  byre registry init stable

Makes the schema "byre" in the database, as its owner, unless it is there, and adds sites that are not there. Accounts
get their roles by "byre registry admit". What is in the database, and who may do what: docs/reference/registry.md.)";

constexpr const char* kMigrateFooter = R"(Example:
  byre registry migrate --registry postgresql://admin@db.example.org/byre

Applies the changes of the schema that are newer than the registry, each in a transaction. Clients that are too old for
the result are refused from then on. Make a backup first (pg_dump).)";

constexpr const char* kAdmitFooter = R"(Examples:
  byre registry admit robot_1 robot --site barn
  byre registry admit ann reviewer
  byre registry admit worker_1 worker

Creates the account without a password if it is missing; give it one by \password of psql, or use certificates. A robot
reads accepted versions of its site and adds sessions. A reviewer proposes, accepts and rejects versions. A worker runs
jobs and proposes their results. Needs an account that may create roles.)";

ExitCode run_init(const InitOptions& options, std::ostream& result) {
  Connection connection(options.uri);
  const int before = migrate_registry(connection);
  result << row("schema", fmt::format("{}{} in {}", kRegistrySchema, before == kRegistrySchema ? ", as before," : "",
                                      connection.place()));
  for (const std::string& site : options.sites) {
    const Rows added = connection.run("INSERT INTO byre.site (name) VALUES ($1) ON CONFLICT DO NOTHING", {site});
    result << row("site", site + (added.changed() == 0 ? ", as before" : ""));
  }
  return ExitCode::done;
}

ExitCode run_migrate(const std::string& uri, std::ostream& result) {
  Connection connection(uri);
  if (registry_schema(connection) == 0) open_registry(uri);  // reports that it is none
  result << row("schema",
                fmt::format("{} -> {} in {}", migrate_registry(connection), kRegistrySchema, connection.place()));
  return ExitCode::done;
}

ExitCode run_admit(const AdmitOptions& options, std::ostream& result) {
  Connection connection = open_registry(options.uri);
  const std::optional<std::string> site =
      options.site ? std::optional(std::to_string(site_number(connection, *options.site))) : std::nullopt;
  connection.run("SELECT byre.admit($1, $2, $3)", {options.account, options.role, site});
  result << row(options.role, options.account + (options.site ? " of " + *options.site : ""));
  return ExitCode::done;
}

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

struct ReviewOptions {
  std::string uri;
  std::string site;
  std::string version;
  std::string reason;
};

struct RequestOptions {
  std::string uri;
  std::string site;
  std::vector<std::string> merged;
  std::string summarised;
  std::string recording;
  std::string calibration;
  int keyframes = kPlaceBudget;
};

constexpr const char* kAcceptFooter = R"(Example:
  byre registry accept barn 3f2a90cc51d07be4 --reason "diff looks right"

The accepted version is the one that robots pull; the one before is retired. A version that was made of others is
accepted only if the present one is among these, so that no update is lost. "byre registry pull --version" and "byre
diff" show the changes.)";

constexpr const char* kRejectFooter = R"(Example:
  byre registry reject barn 3f2a90cc51d07be4 --reason "the gate is missing"

The sessions that it was made of are not used again.)";

constexpr const char* kRollbackFooter = R"(Examples:
  byre registry rollback barn --reason "robots get lost at the feed store"
  byre registry rollback barn --version 3f2a90cc51d07be4

Retires the accepted version and accepts the one before again, or VERSION, which was accepted before.)";

constexpr const char* kRequestFooter = R"(Examples:
  byre registry request barn
  byre registry request barn --merge 3f2a90cc51d07be4 90b1c2ffe0217a6d
  byre registry request barn --map /srv/recordings/barn_day_1
  byre registry request barn --summarise 3f2a90cc51d07be4 --keyframes 6

Sessions request updates of their site themselves; a request repeats one that was set aside. A merge puts the second
version into the first. A recording is a path that workers read, on a file system that they share. A summary keeps the
most useful keyframes of each place (1 m, 0.5 rad), and those without which frames would be localised worse. "byre
worker" runs the job, whose result is a proposed version.)";

ExitCode run_review(const ReviewOptions& options, Review review, std::ostream& result) {
  Connection connection = open_registry(options.uri);
  const std::optional<std::string> version = options.version.empty() ? std::nullopt : std::optional(options.version);
  const std::int64_t site = site_number(connection, options.site);
  result << row(review == Review::reject ? "rejected" : "accepted",
                review_version(connection, review, site, version, options.reason));
  return ExitCode::done;
}

Action declare_review(CLI::App& command, Review review) {
  const auto options = std::make_shared<ReviewOptions>();
  add_site(command, options->site);
  if (review == Review::rollback) {
    add_text(command, "--version", options->version, "Another version than the one before")->type_name("ID");
  } else {
    add_version_id(command, options->version);
  }
  add_reason(command, options->reason);
  add_registry(command, options->uri);
  return [=](std::ostream& result) { return run_review(*options, review, result); };
}

ExitCode run_request(const RequestOptions& options, std::ostream& result) {
  Connection connection = open_registry(options.uri);
  const std::int64_t site = site_number(connection, options.site);
  const bool is_summary = !options.summarised.empty();
  const std::string kind = !options.recording.empty() ? "map"
                           : is_summary               ? "summarise"
                           : !options.merged.empty()  ? "merge"
                                                      : "update";
  const Rows added = connection.run(
      "INSERT INTO byre.job (site, kind, maps, recording, calibration, keyframes) VALUES ($1, $2, $3, $4, $5, $6) "
      "ON CONFLICT DO NOTHING",
      {site, kind, is_summary ? std::vector{options.summarised} : options.merged, options.recording,
       options.calibration, is_summary ? options.keyframes : 0});
  connection.run("SELECT pg_notify('byre_job', '')");
  result << row("requested", kind + (added.changed() == 0 ? ", as before" : ""));
  return ExitCode::done;
}

}  // namespace

Action declare_registry_init(CLI::App& command) {
  const auto options = std::make_shared<InitOptions>();
  add_text(command, "SITE", options->sites, "Sites to add")->type_name("SITE");
  add_registry(command, options->uri);
  command.footer(kInitFooter);
  return [options](std::ostream& result) { return run_init(*options, result); };
}

Action declare_registry_migrate(CLI::App& command) {
  const auto uri = std::make_shared<std::string>();
  add_registry(command, *uri);
  command.footer(kMigrateFooter);
  return [uri](std::ostream& result) { return run_migrate(*uri, result); };
}

Action declare_registry_admit(CLI::App& command) {
  const auto options = std::make_shared<AdmitOptions>();
  add_text(command, "ACCOUNT", options->account, "Account of the server")->type_name("ACCOUNT")->required();
  command.add_option("ROLE", options->role, "Role of the account")
      ->type_name("robot|reviewer|worker")
      ->transform(one_of<std::string>({{"robot", "robot"}, {"reviewer", "reviewer"}, {"worker", "worker"}}))
      ->required();
  add_text(command, "--site", options->site, "Site of the robot")->type_name("SITE");
  add_registry(command, options->uri);
  command.footer(kAdmitFooter);
  return [options](std::ostream& result) { return run_admit(*options, result); };
}

Action declare_registry_push(CLI::App& command) {
  const auto options = std::make_shared<PushOptions>();
  add_site(command, options->site);
  add_input(command, Input::file, "FILE", options->files, "Maps and sessions");
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
  add_output(command, Output::map, "-o,--output", options->output, "Map file");
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

Action declare_registry_accept(CLI::App& command) {
  command.footer(kAcceptFooter);
  return declare_review(command, Review::accept);
}

Action declare_registry_reject(CLI::App& command) {
  command.footer(kRejectFooter);
  return declare_review(command, Review::reject);
}

Action declare_registry_rollback(CLI::App& command) {
  command.footer(kRollbackFooter);
  return declare_review(command, Review::rollback);
}

Action declare_registry_request(CLI::App& command) {
  const auto options = std::make_shared<RequestOptions>();
  add_site(command, options->site);
  CLI::Option* const merge = add_text(command, "--merge", options->merged, "Merge these versions");
  merge->type_name("FIRST SECOND")->expected(2);
  CLI::Option* const map = add_text(command, "--map", options->recording, "Map this recording, a path of workers");
  map->type_name("PATH")->excludes(merge);
  add_text(command, "--calibration", options->calibration, "Calibration of the recording (its own), a path of workers")
      ->type_name("PATH")
      ->needs(map);
  CLI::Option* const summarise = add_text(command, "--summarise", options->summarised, "Reduce this version");
  summarise->type_name("ID")->excludes(merge)->excludes(map);
  command.add_option("--keyframes", options->keyframes, "Keyframes that a place keeps in the summary")
      ->check(between(1, 1000))
      ->capture_default_str()
      ->needs(summarise);
  add_registry(command, options->uri);
  command.footer(kRequestFooter);
  return [options](std::ostream& result) { return run_request(*options, result); };
}

void add_registry(CLI::App& command, std::string& uri) {
  add_text(command, "--registry", uri, "PostgreSQL database, postgresql://HOST/DATABASE (PGHOST, PGSERVICE, ...)")
      ->type_name("URI");
}

void add_site(CLI::App& command, std::string& site) {
  add_text(command, "SITE", site, "Name of the site")->type_name("SITE")->required();
}

CLI::Option* add_version_id(CLI::App& command, std::string& id) {
  return add_text(command, "VERSION", id, "Id of the version, as in \"byre history\"")->type_name("ID")->required();
}

void add_reason(CLI::App& command, std::string& reason) {
  add_text(command, "--reason", reason, "Reason, for the history of the site")->type_name("TEXT");
}

Action declare_registry(CLI::App& command) {
  return declare_subcommands(
      command, {{"init", "Make a database a registry, and add sites", declare_registry_init},
                {"migrate", "Update the schema of a registry to that of this byre", declare_registry_migrate},
                {"admit", "Give an account a role: robot of a site, reviewer or worker", declare_registry_admit},
                {"push", "Propose maps, add sessions of missions and floor plans", declare_registry_push},
                {"pull", "Write the accepted version of a site's map, or its floor plan", declare_registry_pull},
                {"list", "List sites, or versions, open sessions and jobs of a site", declare_registry_list},
                {"show", "Show a version with its sessions and reviews, or plans", declare_registry_show},
                {"accept", "Accept a proposed version for all robots of the site", declare_registry_accept},
                {"reject", "Reject a proposed version", declare_registry_reject},
                {"rollback", "Accept an earlier version again", declare_registry_rollback},
                {"request", "Request an update, a merge, a map or a summary of a site", declare_registry_request},
                {"history", "Print who did what at a site, and why", declare_registry_history},
                {"watch", "Print a line for each version of a site that is accepted", declare_registry_watch},
                {"metrics", "Print the state of all sites and robots for Prometheus", declare_registry_metrics},
                {"serve", "Review versions of maps in a browser", declare_registry_serve}});
}

}  // namespace byre::cli
